// What is left of gaps at corners of the mesh where some edges are concave.
#pragma once

#include "core/cells/surface_mesh.h"
#include "core/data/lattice.h"
#include "core/sharpening/sharpen.h"

namespace raycone {

// Fills gaps that fill_gap() alone cannot: where faces of a plane reach beyond a corner of the mesh, which would have
// to be folded, all faces around the corner are made anew. What makes faults is left as it was (fill_all()).
// Nothing is done where it is not planes that the mesh is made of. Precondition: the surface is closed. Returns whether
// any gap has been filled; else the surface is as it was. The same for any number of threads. Needs
// DefaultFloatingPoint.
[[nodiscard]] bool fill_corner_gaps(SurfaceMesh& surface, const SharpenInput& input, const Lattice& lattice,
                                    const SharpenLimits& limits);

}  // namespace raycone
