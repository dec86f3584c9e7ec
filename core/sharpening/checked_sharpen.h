// Sharp edges where a lattice does not see them, as far as that does no harm.
#pragma once

#include "core/cells/node_set.h"
#include "core/cells/surface_mesh.h"
#include "core/sharpening/sharpen.h"

namespace raycone {

// What Sharpener makes of a surface without faults, without what makes faults: around these nothing is pulled; where
// that does not help, nothing at all. A face that crosses an edge of the lattice off the mesh is a fault, too. Only
// what is near a change is looked at (faults_near(), changed_nodes()). `rounds`: how often is looked for faults at
// most. Returns whether anything has been pulled; else the surface is as it was. The same for any number of threads.
// Needs DefaultFloatingPoint.
[[nodiscard]] bool checked_sharpen(SurfaceMesh& surface, const SharpenInput& input, const NodeSet& inside,
                                   const SharpenLimits& limits, int rounds = 11);

}  // namespace raycone
