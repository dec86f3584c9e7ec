// Fewer triangles for nearly the same surface.
#pragma once

#include <vector>

#include "core/cells/node_set.h"
#include "core/cells/surface_mesh.h"
#include "core/merging/merge_planes.h"

namespace raycone {

// The closed surface with vertices pulled into neighbours along edges. No point of the result is farther from the
// surface than `most`, world units, and no point of the surface farther from the result; no node of the lattice changes
// sides. Faces keep their order and sources; vertices keep their numbers and places, and some are no longer used. Those
// of `kept` stay. Parts that are as near to each other as `most` may cross: that is for the caller to find.
[[nodiscard]] MergedFaces simplify(const SurfaceMesh& surface, const NodeSet& inside, const std::vector<bool>& kept,
                                   double most);

}  // namespace raycone
