#include "core/mesh/normalize.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/data/triangle_mesh.h"

namespace raycone {
namespace {

// The box of its triangles is 4 x 2 x 1 about (1, 1, 0.5); the vertex that is farthest from there is used once. Another
// one, farther by far, is not used.
TriangleMesh mesh_beside_a_stray_vertex() {
  TriangleMesh mesh;
  mesh.vertices = {{-1, 0, 0}, {3, 0, 0.5}, {1, 2, 0}, {1, 1, 1}, {100, -100, 50}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}};
  return mesh;
}

TriangleMesh normalized(TriangleMesh mesh, const Normalize& normalize) {
  raycone::apply(normalization_of(mesh, normalize), mesh.vertices);
  return mesh;
}

double farthest_used(const TriangleMesh& mesh) {
  double most = 0.0;
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      const Vec3& v = mesh.vertices[corner];
      most = std::max(most, std::hypot(v.x, v.y, v.z));
    }
  }
  return most;
}

// A difference, a product and a quotient, each rounded: 2^-51 of the result, and of the reference as much.
constexpr double kRounding = 0x1p-50;

TEST(Normalize, ToACubeGivesTheLongestSideTheSize) {
  for (const double size : {1.0, 3.0, 1e-7}) {
    const TriangleMesh mesh = normalized(mesh_beside_a_stray_vertex(), {NormalizeTo::kCube, size});
    const Box box = bounding_box(mesh);
    EXPECT_NEAR(longest_side(box), size, size * kRounding);
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(box.lower[axis], -box.upper[axis], size * kRounding) << axis;
  }
}

TEST(Normalize, ToASphereBringsTheFarthestUsedVertexToItsRadius) {
  for (const double size : {1.0, 2.0, 1e9}) {
    const TriangleMesh mesh = normalized(mesh_beside_a_stray_vertex(), {NormalizeTo::kSphere, size});
    EXPECT_NEAR(farthest_used(mesh), size / 2, size * kRounding);
    EXPECT_GT(std::abs(mesh.vertices.back().x), size) << "moved with the others, but of no effect";
  }
}

TEST(Normalize, HasNoFactorWhereDoublesCannotSayIt) {
  const auto factor = [](const TriangleMesh& mesh, NormalizeTo to) { return normalization_of(mesh, {to, 1.0}).factor; };
  const auto triangle = [](double size) { return TriangleMesh{{{0, 0, 0}, {size, 0, 0}, {0, size, 0}}, {{0, 1, 2}}}; };
  constexpr double kMost = std::numeric_limits<double>::max();
  for (const NormalizeTo to : {NormalizeTo::kCube, NormalizeTo::kSphere}) {
    EXPECT_FALSE(std::isfinite(factor(triangle(0.0), to)));
    EXPECT_FALSE(std::isfinite(factor(triangle(1e-320), to)));
    TriangleMesh wide = triangle(kMost);
    wide.vertices[0].x = -kMost;  // a side that overflows
    const double of_wide = factor(wide, to);
    EXPECT_TRUE(of_wide == 0.0 || !std::isfinite(of_wide)) << of_wide;
    for (const double size : {1e-300, 1e300}) {  // whose squares are no doubles
      const double of_size = factor(triangle(size), to) * size;
      EXPECT_NEAR(of_size, to == NormalizeTo::kCube ? 1.0 : std::sqrt(0.5), kRounding) << size;
    }
  }
}

}  // namespace
}  // namespace raycone
