// Whether the nodes of a lattice tell of a mesh.
#pragma once

#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/surface/node_set.h"

namespace raycone {

// Whether each component, given as its triangles, passes through a cell with nodes of both kinds, and has no point
// farther from such a cell than a few voxels: it is sure to be so within four along each axis, and not beyond eleven;
// and all of them are within the lattice. Judged in the middles of small parts of triangles. The same for any number of
// threads. Precondition: !inside.reaches_border(), vertices of triangles are finite.
[[nodiscard]] bool are_seen_by(const NodeSet& inside, const std::vector<std::vector<Triangle>>& components,
                               const std::vector<Vec3>& vertices);

}  // namespace raycone
