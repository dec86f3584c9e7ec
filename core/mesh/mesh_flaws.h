// Where a mesh is not what it should be.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/mesh/edge_uses.h"

namespace raycone {

// The edges that are exterior, inconsistent or non-manifold, by increasing low, then high.
[[nodiscard]] std::vector<EdgeUse> flawed_edges(const TriangleMesh& mesh);

// Indices of the triangles at an edge, in increasing order.
[[nodiscard]] std::vector<std::uint32_t> triangles_at(const TriangleMesh& mesh, const EdgeUse& edge);

// The first triangle that has the same three vertices as an earlier one, in either orientation, behind the first of
// these. Nothing where there is none.
[[nodiscard]] std::optional<std::array<std::uint32_t, 2>> first_duplicate(const TriangleMesh& mesh);

}  // namespace raycone
