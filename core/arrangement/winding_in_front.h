// Winding numbers of a closed mesh in front of triangles of its arrangement.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/arrangement/arrangement.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// The winding number of `mesh` just in front of each of some triangles, given by their numbers. Exact: of a point
// within the triangle, a ray along an axis counts the faces of the mesh that it leaves through; another point is tried
// where it meets an edge. None where such rays still do after some. The same for any number of threads; uses those that
// ThreadLimit allows. Precondition: `mesh` is what the arrangement is of, and is closed. Needs DefaultFloatingPoint.
[[nodiscard]] std::optional<std::vector<std::int64_t>> windings_in_front(const std::vector<std::uint32_t>& triangles,
                                                                         Arrangement& arrangement,
                                                                         const TriangleMesh& mesh);

}  // namespace raycone
