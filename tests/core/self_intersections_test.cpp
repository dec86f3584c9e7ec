// Counts of intersecting pairs, against all pairs in rational numbers.
#include "core/intersections/self_intersections.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "core/intersections/triangle_pair.h"
#include "core/machine/floating_point.h"
#include "tests/support/exact_intersections.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

void expect_pairs(const TriangleMesh& mesh, const std::vector<TrianglePair>& expected) {
  const SelfIntersections found = self_intersections(mesh);
  EXPECT_EQ(found.pairs, expected.size());
  std::vector<bool> of_triangle(mesh.triangles.size(), false);
  for (const TrianglePair& pair : expected) of_triangle[pair[0]] = of_triangle[pair[1]] = true;
  EXPECT_EQ(found.of_triangle, of_triangle);
  EXPECT_EQ(found.first.has_value(), !expected.empty());
  if (found.first) {
    EXPECT_EQ(std::ranges::count(expected, *found.first), 1);
  }
  EXPECT_EQ(first_self_intersection(mesh), found.first);
}

void expect_oracle(const TriangleMesh& mesh) { expect_pairs(mesh, test::exact_self_intersections(mesh)); }

// What a look at all pairs finds, for meshes that are too large for the oracle.
void expect_all_pairs(const TriangleMesh& mesh) {
  const auto corners = [&mesh](std::uint32_t i) {
    const Triangle& t = mesh.triangles[i];
    return Corners3{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
  };
  const DefaultFloatingPoint guard;
  std::vector<TrianglePair> expected;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    for (std::uint32_t j = i + 1; j < mesh.triangles.size(); ++j) {
      if (meet_beyond_shared(corners(i), corners(j))) expected.push_back({i, j});
    }
  }
  expect_pairs(mesh, expected);
}

TEST(SelfIntersections, OfSolidsAreNone) {
  for (const TriangleMesh& mesh :
       {test::box_mesh({0, 0, 0}, {1, 2, 3}), test::open_box(), test::sphere(20), test::reversed(test::sphere(3))}) {
    EXPECT_EQ(self_intersections(mesh).pairs, 0U);
    EXPECT_EQ(first_self_intersection(mesh), std::nullopt);
  }
}

TEST(SelfIntersections, OfOverlappingSolidsAreFound) {
  expect_oracle(test::joined(test::box_mesh({0, 0, 0}, {2, 2, 2}), test::box_mesh({1, 1, 1}, {3, 3, 3})));
  expect_oracle(
      test::joined(test::box_mesh({0, 0, 0}, {2, 2, 2}), test::box_mesh({2, 0, 0}, {3, 2, 2})));  // side on side
  expect_oracle(test::joined(test::box_mesh({0, 0, 0}, {2, 2, 2}), test::box_mesh({0, 0, 0}, {2, 2, 2})));  // the same
  expect_all_pairs(test::joined(test::sphere(6), test::moved(test::sphere(6), {1, 1, 1}, {0.5, 0.25, 0})));
  expect_all_pairs(test::joined(test::sphere(6), test::reversed(test::sphere(6))));
}

TEST(SelfIntersections, OfOneSolidInAnotherAreNone) {
  EXPECT_EQ(self_intersections(test::joined(test::sphere(4), test::moved(test::sphere(4), {0.5, 0.5, 0.5}, {}))).pairs,
            0U);
}

TEST(SelfIntersections, OfSoupsAreThoseOfTheOracle) {
  test::Random random(1);
  expect_oracle(test::soup(random, 12));
  expect_oracle(test::lattice_soup(random, 20, 3));
  expect_oracle(test::random_cells(random, 2));
  expect_oracle(test::fan(5, 2));
  expect_oracle(test::assorted_triangles());
}

// Trees of one to three levels, the last nodes of which are not full.
TEST(SelfIntersections, AreFoundInTreesOfAnySize) {
  test::Random random(2);
  for (const int triangles : {1, 2, 7, 8, 9, 63, 64, 65, 70, 513}) {
    expect_all_pairs(test::soup(random, triangles));
  }
}

TEST(SelfIntersections, DoNotDependOnTheOrderOfFaces) {
  test::Random random(3);
  const TriangleMesh mesh = test::lattice_soup(random, 500, 12);
  const SelfIntersections once = self_intersections(mesh);
  EXPECT_GT(once.pairs, 100U);
  EXPECT_EQ(self_intersections(test::shuffled(mesh, random)).pairs, once.pairs);
}

TEST(SelfIntersections, AreTheSameOnAnyThread) {
  test::Random random(4);
  const TriangleMesh mesh = test::soup(random, 500);
  const SelfIntersections once = self_intersections(mesh);
  for (int n = 0; n < 5; ++n) {
    EXPECT_EQ(self_intersections(mesh).first, once.first);
    EXPECT_EQ(first_self_intersection(mesh), once.first);
  }
}

// Boxes of all pairs meet, and a count would look at all of them: 8 * 10^8.
TEST(SelfIntersections, TheFirstIsFoundBeforeAllAreCounted) {
  TriangleMesh mesh;
  const std::uint32_t triangles = 40000;
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const double angle = i, far = 1.0 + 1e-5 * i;
    mesh.vertices.insert(mesh.vertices.end(), {{-far, -far, -far}, {far, far, far}, {0, angle, -angle}});
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  EXPECT_NE(first_self_intersection(mesh), std::nullopt);
}

}  // namespace
}  // namespace raycone
