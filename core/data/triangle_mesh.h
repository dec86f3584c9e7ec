// An indexed triangle mesh in double precision.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/data/box.h"
#include "core/data/vec3.h"

namespace raycone {

// Corners of a triangle as indices into TriangleMesh::vertices; the front side sees them counter-clockwise.
using Triangle = std::array<std::uint32_t, 3>;

// Whether two corners are one vertex.
[[nodiscard]] inline bool is_collapsed(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

// The place of a corner among the three.
[[nodiscard]] inline std::size_t place_in(const Triangle& t, std::uint32_t corner) {
  return t[0] == corner ? 0 : t[1] == corner ? 1 : 2;
}

// Evaluators count the triangles at an edge and along a ray in 32 bits, with a sign.
inline constexpr std::size_t kMaxTriangles = 0x7FFFFFFF;

struct TriangleMesh {
  std::vector<Vec3> vertices;  // some may be unused; an unused one may be non-finite
  std::vector<Triangle> triangles;
};

// Where the corners of a triangle are, in its order.
using Corners3 = std::array<Vec3, 3>;

[[nodiscard]] inline Corners3 corners_of(const std::vector<Vec3>& vertices, const Triangle& triangle) {
  return {vertices[triangle[0]], vertices[triangle[1]], vertices[triangle[2]]};
}
[[nodiscard]] inline Corners3 corners_of(const TriangleMesh& mesh, const Triangle& triangle) {
  return corners_of(mesh.vertices, triangle);
}

[[nodiscard]] inline Box box_of(const Corners3& corners) { return box_of(corners[0], corners[1], corners[2]); }

// The smallest box of the vertices that triangles use; of no triangles, empty_box().
[[nodiscard]] Box bounding_box(const std::vector<Triangle>& triangles, const std::vector<Vec3>& vertices);
[[nodiscard]] inline Box bounding_box(const TriangleMesh& mesh) { return bounding_box(mesh.triangles, mesh.vertices); }

// Of one triangle, world units squared; where squares over- or underflow, too.
[[nodiscard]] double area_of_triangle(const TriangleMesh& mesh, const Triangle& triangle);
[[nodiscard]] double total_area(const TriangleMesh& mesh);  // of all, likewise

}  // namespace raycone
