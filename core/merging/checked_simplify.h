// Fewer triangles for nearly the same surface, as far as that does no harm.
#pragma once

#include "core/cells/node_set.h"
#include "core/cells/surface_mesh.h"

namespace raycone {

// Runs simplify() on a surface without faults, and takes back pulls that make faults: those into faces that intersect
// others or are next to nodes on the wrong side, and those that turn a component over or make it flat. `most`: how far
// the surface may move, world units; `rounds`: how often faults are looked for at most. Returns whether the result has
// no faults; else the surface is as it was. The same for any number of threads. Needs DefaultFloatingPoint.
[[nodiscard]] bool checked_simplify(SurfaceMesh& surface, const NodeSet& inside, double most, int rounds);

}  // namespace raycone
