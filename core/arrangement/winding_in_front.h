// Winding numbers of a closed mesh in front of triangles of its arrangement.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/arrangement/arrangement.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// The winding number of `mesh` just in front of each of these triangles of its arrangement, in their order. Exact: a
// ray along an axis starts at a point within the triangle, and counts the faces of the mesh that it leaves through,
// less those that it enters through. Where the ray meets an edge, another point is tried; none where the rays from
// eight points of a triangle all do. Adds points to the arrangement. Uses the threads that ThreadLimit allows; the same
// for any number of them. Precondition: `mesh` is what the arrangement is of, and is closed. Needs
// DefaultFloatingPoint.
[[nodiscard]] std::optional<std::vector<std::int64_t>> windings_in_front(const std::vector<std::uint32_t>& triangles,
                                                                         Arrangement& arrangement,
                                                                         const TriangleMesh& mesh);

}  // namespace raycone
