// Sharp edges where a lattice does not see them, as far as that does no harm.
#pragma once

#include "core/cells/node_set.h"
#include "core/cells/surface_mesh.h"
#include "core/sharpening/sharpen.h"

namespace raycone {

// Sharpens a surface that has no faults (Sharpener), and takes back what makes faults: vertices around them are not
// pulled; where that does not help, none are. A face that crosses a mixed edge of the lattice off the mesh is a fault,
// too. Only what is near a change is looked at (faults_near(), changed_nodes()). `rounds`: how often faults are looked
// for at most. Returns whether anything has been pulled; else the surface is as it was. Uses the threads that
// ThreadLimit allows; the same for any number of them. Needs DefaultFloatingPoint.
[[nodiscard]] bool checked_sharpen(SurfaceMesh& surface, const SharpenInput& input, const NodeSet& inside,
                                   const SharpenLimits& limits, int rounds = 11);

}  // namespace raycone
