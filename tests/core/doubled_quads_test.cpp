// Quadrilaterals that are stored on both sides, as modelling programs write them: the second list of corners is the
// first one from back to front, so that a fan from its first corner has the other diagonal.
#include "core/orientation/doubled_quads.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/evaluation/winding_number.h"
#include "core/orientation/orient.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using QuadCorners = std::array<std::uint32_t, 4>;

// As readers cut convex polygons.
void add_fan(const QuadCorners& q, TriangleMesh& mesh) {
  mesh.triangles.push_back({q[0], q[1], q[2]});
  mesh.triangles.push_back({q[0], q[2], q[3]});
}

// Of (0, 0, 0) to (1, 1, 1), outward.
constexpr std::array<QuadCorners, 6> kSides{
    {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};

TriangleMesh cube_corners() {
  TriangleMesh mesh;
  for (int n = 0; n < 8; ++n) {
    mesh.vertices.push_back({static_cast<double>(n & 1), static_cast<double>(n >> 1 & 1), static_cast<double>(n >> 2)});
  }
  return mesh;
}

// `start`: where the second list begins, counted from the end of the first one.
TriangleMesh double_sided(std::size_t start, bool reversed) {
  TriangleMesh mesh = cube_corners();
  for (const QuadCorners& side : kSides) add_fan(side, mesh);
  for (const QuadCorners& side : kSides) {
    QuadCorners copy;
    for (std::size_t n = 0; n < 4; ++n) copy[n] = side[(reversed ? 7 - n - start : n + start) % 4];
    add_fan(copy, mesh);
  }
  return mesh;
}

double winding_number(const TriangleMesh& mesh, const Vec3& q) {
  double w = 0.0;
  WindingNumberEvaluator(mesh).evaluate({&q, 1}, {&w, 1});
  return w;
}

TEST(DoubledQuads, AreOneFaceHoweverTheSecondIsCut) {
  for (const bool reversed : {true, false}) {
    for (std::size_t start = 0; start < 4; ++start) {
      const TriangleMesh mesh = double_sided(start, reversed);
      const OrientedMesh result = orient(mesh, Orient::kAuto);
      EXPECT_EQ(result.counts.dropped_duplicates, 12U) << start;
      EXPECT_EQ(winding_number(result.mesh, {0.3, 0.4, 0.6}), 1.0) << start;
      EXPECT_EQ(winding_number(result.mesh, {1.3, 0.4, 0.6}), 0.0) << start;
    }
  }
}

// By coordinates, each in the least of its rotations.
std::vector<std::array<Vec3, 3>> sorted_faces(const TriangleMesh& mesh) {
  const auto is_before = [](const Vec3& a, const Vec3& b) { return lexicographic_order(a, b) < 0; };
  std::vector<std::array<Vec3, 3>> faces;
  for (const Triangle& t : mesh.triangles) {
    std::array<Vec3, 3> face{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
    std::ranges::rotate(face, std::ranges::min_element(face, is_before));
    faces.push_back(face);
  }
  std::ranges::sort(faces, [&](const auto& a, const auto& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), is_before);
  });
  return faces;
}

TEST(DoubledQuads, AreOneFaceAtAnyScale) {
  for (const double scale : {1e-300, 1e-200, 1e150, 1e300}) {
    TriangleMesh mesh = double_sided(0, true);
    for (Vec3& v : mesh.vertices) v = scale * v;
    EXPECT_EQ(orient(mesh, Orient::kAuto).counts.dropped_duplicates, 12U) << scale;
  }
}

TEST(DoubledQuads, AreCutByCoordinatesAlone) {
  test::Random random(2);
  const TriangleMesh mesh = double_sided(0, true);
  const std::vector<std::array<Vec3, 3>> expected = sorted_faces(orient(mesh, Orient::kAuto).mesh);
  ASSERT_EQ(expected.size(), 12U);
  for (int round = 0; round < 20; ++round) {
    const OrientedMesh result = orient(test::shuffled(mesh, random), Orient::kAuto);
    EXPECT_EQ(sorted_faces(result.mesh), expected) << round;
  }
}

TEST(DoubledQuads, AreOneFaceInATurnedMeshOfFloats) {
  test::Random random(1);
  for (int round = 0; round < 50; ++round) {
    TriangleMesh mesh = double_sided(static_cast<std::size_t>(round) % 4, true);
    const Vec3 x{test::uniform(random, -1, 1), test::uniform(random, -1, 1), test::uniform(random, -1, 1)};
    const Vec3 y = cross(x, {test::uniform(random, -1, 1), test::uniform(random, -1, 1), 0.1}), z = cross(x, y);
    Vec3 middle;
    for (Vec3& v : mesh.vertices) {
      const Vec3 p = Vec3{5, -3, 2} + v.x * x + v.y * y + v.z * z;
      v = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
      middle = middle + 0.125 * v;
    }
    const OrientedMesh result = orient(mesh, Orient::kAuto);
    EXPECT_EQ(result.counts.dropped_duplicates, 12U) << round;
    EXPECT_EQ(winding_number(result.mesh, middle), 1.0) << round;
  }
}

// A tetrahedron has the four faces that two copies of a quadrilateral have.
TEST(DoubledQuads, AreNoTetrahedra) {
  for (const double height : {1.0, 1e-3, 1e-5}) {
    TriangleMesh mesh;
    for (const double x : {0.0, 1.0}) {  // two that share an edge, and so have crowded edges
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      mesh.vertices.insert(mesh.vertices.end(), {{x, 0, 0}, {x, 1, height}, {x + 1, 0, height}, {x + 1, 1, 0}});
      for (const Triangle& t : std::array<Triangle, 4>{{{0, 1, 3}, {0, 3, 2}, {1, 0, 2}, {1, 2, 3}}}) {
        mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      }
    }
    mesh.vertices[4] = mesh.vertices[2], mesh.vertices[5] = mesh.vertices[3];
    const OrientedMesh result = orient(mesh, Orient::kAuto);
    EXPECT_EQ(result.counts.dropped_duplicates, 0U) << height;
    EXPECT_EQ(winding_number(result.mesh, {0.5, 0.5, height / 2}), 1.0) << height;
  }
}

// Nor are those that have the four edges around in common with others: a corner is off the planes of its three sides.
TEST(DoubledQuads, AreFlat) {
  for (const double height : {1e-3, 1e-5}) {
    TriangleMesh mesh = double_sided(0, true);
    mesh.vertices[7] = mesh.vertices[7] + height * Vec3{1, 2, 3};
    EXPECT_EQ(orient(mesh, Orient::kAuto).counts.dropped_duplicates, 0U) << height;
  }
}

// Two cubes with a wall in common, which each of them needs.
TEST(DoubledQuads, AreNoWalls) {
  TriangleMesh mesh = double_sided(0, true);
  mesh.triangles.resize(12);
  for (int n = 0; n < 8; ++n) mesh.vertices.push_back(mesh.vertices[static_cast<std::size_t>(n)] + Vec3{1, 0, 0});
  for (std::uint32_t side = 0; side < 6; ++side) {
    QuadCorners copy;
    for (std::size_t n = 0; n < 4; ++n) copy[n] = 8 + kSides[side][(n + 1) % 4];
    add_fan(copy, mesh);
  }
  const OrientedMesh result = orient(mesh, Orient::kAuto);
  EXPECT_EQ(result.counts.dropped_duplicates, 0U);
  EXPECT_EQ(winding_number(result.mesh, {0.9, 0.4, 0.6}), 1.0);
  EXPECT_EQ(winding_number(result.mesh, {1.1, 0.4, 0.6}), 1.0);
}

// Beside them all stays as it is.
TEST(DoubledQuads, AreNotTrianglesOfOtherFaces) {
  TriangleMesh mesh = double_sided(0, true);
  mesh.triangles.resize(12);
  const std::vector<Triangle> before = mesh.triangles;
  mesh.triangles.push_back({0, 7, 3});  // makes an edge of three faces
  const OrientedMesh result = orient(mesh, Orient::kAuto);
  EXPECT_EQ(result.counts.dropped_duplicates, 0U);
  for (std::size_t n = 0; n < before.size(); ++n) EXPECT_EQ(result.mesh.triangles[n], before[n]);
}

}  // namespace
}  // namespace raycone
