// What is left of gaps at corners of the mesh where some edges are concave.
#pragma once

#include "core/cells/surface_mesh.h"
#include "core/data/lattice.h"
#include "core/sharpening/sharpen.h"

namespace raycone {

// Fills gaps that are left, as far as that makes no faults (fill_all()). Where faces of a plane reach beyond a corner
// of the mesh, so that fill_gap() would have to fold them, all faces around the corner are made anew. Does nothing
// unless the surface is mostly in planes (are_mostly_in_planes()). Returns whether any gap has been filled; else the
// surface is as it was. Precondition: the surface is closed. The same for any number of threads. Needs
// DefaultFloatingPoint.
[[nodiscard]] bool fill_corner_gaps(SurfaceMesh& surface, const SharpenInput& input, const Lattice& lattice,
                                    const SharpenLimits& limits);

}  // namespace raycone
