// Whether the nodes of a lattice tell of a mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "core/cells/node_set.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

enum class Sight : std::uint8_t {
  kUnseen,  // passes through no mixed cell (with nodes of both kinds): no node is within what it is the border of
  kInPart,  // passes through some, but has points farther from all of them than a few voxels
  kWhole,   // passes through some, and has no such points
};

// How the lattice sees each component, given as its triangles. A component that is not all within the lattice is seen
// in part. A point is near enough to a mixed cell within four voxels along each axis, and too far beyond eleven; in
// between it may be either. Judged in the middles of small parts of triangles. Uses the threads that ThreadLimit
// allows; the same for any number of them. Preconditions: !inside.reaches_border(); vertices of triangles are finite.
[[nodiscard]] std::vector<Sight> sights_of(const NodeSet& inside, const std::vector<std::vector<Triangle>>& components,
                                           const std::vector<Vec3>& vertices);

}  // namespace raycone
