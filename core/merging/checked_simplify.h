// Fewer triangles for nearly the same surface, as far as that does no harm.
#pragma once

#include "core/cells/node_set.h"
#include "core/cells/surface_mesh.h"

namespace raycone {

// simplify() of a surface without faults, without what makes faults: pulls into faces that intersect others, or have
// nodes on the wrong side next to them, are undone, and those that turn a component over or make it flat.
// `most`: world units; `rounds`: how often is looked for faults at most. Returns whether none is left; else the surface
// is as it was. The same for any number of threads. Needs DefaultFloatingPoint.
[[nodiscard]] bool checked_simplify(SurfaceMesh& surface, const NodeSet& inside, double most, int rounds);

}  // namespace raycone
