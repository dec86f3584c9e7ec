// Whether the nodes of a lattice tell of a mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "core/cells/node_set.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

enum class Sight : std::uint8_t {
  kUnseen,  // passes through no cell with nodes of both kinds: no node is within what it is the border of
  kInPart,  // does, but has points farther from such cells than a few voxels
  kWhole,
};

// How the lattice sees each component, given as its triangles: in part, too, where it is not within the lattice. Points
// are surely near enough within four voxels along each axis of such a cell, and not beyond eleven. Judged in the
// middles of small parts of triangles. The same for any number of threads. Precondition: !inside.reaches_border(),
// vertices of triangles are finite.
[[nodiscard]] std::vector<Sight> sights_of(const NodeSet& inside, const std::vector<std::vector<Triangle>>& components,
                                           const std::vector<Vec3>& vertices);

}  // namespace raycone
