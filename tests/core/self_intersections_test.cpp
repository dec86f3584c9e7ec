// Counts of intersecting pairs, against all pairs in rational numbers.
#include "core/intersections/self_intersections.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <numbers>
#include <vector>

#include "core/intersections/triangle_pair.h"
#include "core/intersections/vertex_graph.h"
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
  const SelfIntersections along_curve = self_intersections(mesh, SearchOrder::kCurve);
  EXPECT_EQ(along_curve.pairs, expected.size());
  EXPECT_EQ(along_curve.of_triangle, of_triangle);
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

// The faces around each vertex of a closed mesh, as steps.
std::vector<std::vector<FanStep>> fans_of(const TriangleMesh& mesh) {
  std::vector<std::vector<FanStep>> fans(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) fans[t[i]].emplace_back(t[(i + 1) % 3], t[(i + 2) % 3]);
  }
  return fans;
}

// Faces around the origin, whose other corners go around the z axis so many times.
bool fan_is_graph(int rounds, int faces, double height, double shift) {
  std::vector<Vec3> vertices{{0, 0, 0}};
  std::vector<FanStep> steps;
  for (int i = 0; i < faces; ++i) {
    const double angle = 2 * std::numbers::pi * rounds * i / faces + 0.1;
    vertices.push_back({std::cos(angle) + shift, std::sin(angle), i % 2 == 0 ? height : -height});
    steps.emplace_back(1 + i, 1 + (i + 1) % faces);
  }
  return is_surely_graph(vertices, 0, steps);
}

TEST(VertexGraph, IsSeenFromItsFrontAndOnce) {
  const DefaultFloatingPoint guard;
  EXPECT_TRUE(fan_is_graph(1, 6, 0.0, 0.0));
  EXPECT_TRUE(fan_is_graph(1, 7, 0.3, 0.5));
  EXPECT_TRUE(fan_is_graph(1, 4, 5.0, 0.0));
  EXPECT_FALSE(fan_is_graph(2, 9, 0.3, 0.0));
  EXPECT_FALSE(fan_is_graph(3, 14, 0.3, 0.0));
  EXPECT_FALSE(fan_is_graph(1, 6, 0.0, 3.0));  // the vertex is outside of its ring: faces are folded
  EXPECT_FALSE(fan_is_graph(1, 2, 0.1, 0.0));
}

// Spheres whose vertices have been moved: by little, so that all faces around a vertex are seen from their fronts, up
// to so far that many are folded over others.
TEST(SelfIntersections, AreTheSameWithoutThePairsAtGraphs) {
  const DefaultFloatingPoint guard;
  test::Random random(17);
  std::uint64_t graphs_in_all = 0, pairs_in_all = 0;
  for (const double by : {0.0, 0.02, 0.05, 0.1, 0.2, 0.4}) {
    TriangleMesh mesh = test::sphere(12);
    for (Vec3& p : mesh.vertices) {
      p = p + by * Vec3{test::uniform(random, -1, 1), test::uniform(random, -1, 1), test::uniform(random, -1, 1)};
    }
    const auto fans = fans_of(mesh);
    std::vector<std::uint8_t> graphs;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
      graphs.push_back(is_surely_graph(mesh.vertices, v, fans[v]) ? 1 : 0);
      graphs_in_all += graphs.back();
    }
    const SelfIntersections all = self_intersections(mesh);
    const SelfIntersections found = self_intersections(mesh, SearchOrder::kCurve, &graphs);
    EXPECT_EQ(found.pairs, all.pairs) << by;
    EXPECT_EQ(found.of_triangle, all.of_triangle) << by;
    EXPECT_EQ(first_self_intersection(mesh, &graphs), first_self_intersection(mesh)) << by;
    pairs_in_all += all.pairs;
  }
  EXPECT_GT(graphs_in_all, 100U);
  EXPECT_GT(pairs_in_all, 100U);
}

// Pairs of some triangles with any others, in whichever order they come in the search.
TEST(SelfIntersections, AreFoundOfSomeTriangles) {
  test::Random random(9);
  for (const double part : {0.0, 0.01, 0.1, 0.5, 1.0}) {
    const TriangleMesh mesh = test::soup(random, 80);
    std::vector<std::uint8_t> of(mesh.triangles.size());
    for (std::uint8_t& one : of) one = test::uniform(random, 0, 1) < part ? 1 : 0;
    std::vector<bool> in_pair(of.size(), false);
    std::uint64_t pairs = 0;
    for (const auto& [a, b] : test::exact_self_intersections(mesh)) {
      if (of[a] == 0 && of[b] == 0) continue;
      ++pairs;
      in_pair[a] = in_pair[b] = true;
    }
    for (const SearchOrder order : {SearchOrder::kRuns, SearchOrder::kCurve}) {
      const SelfIntersections found = self_intersections(mesh, order, nullptr, &of);
      EXPECT_EQ(found.pairs, pairs) << part;
      EXPECT_EQ(found.of_triangle, in_pair) << part;
    }
  }
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

// Small triangles at both ends of a diagonal through the origin, each shorter than its distance from there.
TriangleMesh strays(double distance) {
  const TriangleMesh triangle{{{1, 1, 1}, {1.5, 1, 1}, {1, 1.5, 1}}, {{0, 1, 2}}};
  const Vec3 there{distance, distance, distance};
  return test::joined(test::moved(triangle, there, {}), test::moved(triangle, -1.0 * there, {}));
}

// In units of the whole mesh all boxes of the spheres meet: 8 * 10^8 pairs would be looked at, for a minute or more.
TEST(SelfIntersections, TakeNoLongerBesideStrayTriangles) {
  test::Random random(19);
  const TriangleMesh sphere = test::shuffled(test::sphere(100), random);
  const TriangleMesh other = test::moved(sphere, {0.1, 0.1, 0.1}, {1e8, 0, 0});
  const double before = static_cast<double>(std::clock());
  for (const double distance : {1e9, 1e15, 1e300}) {
    const TriangleMesh mesh = test::joined(test::joined(sphere, other), strays(distance));
    EXPECT_EQ(self_intersections(mesh).pairs, 0U) << distance;
    EXPECT_EQ(first_self_intersection(mesh), std::nullopt) << distance;
  }
  EXPECT_LT((static_cast<double>(std::clock()) - before) / CLOCKS_PER_SEC, 20.0);  // sanitizers, busy machines included
}

TEST(SelfIntersections, AreFoundBesideStrayTriangles) {
  test::Random random(23);
  for (const double distance : {1e3, 1e9, 1e15, 1e300}) {
    const TriangleMesh mesh = test::soup(random, 300);
    const std::uint64_t pairs = self_intersections(mesh).pairs;
    EXPECT_GT(pairs, 100U);
    for (const SearchOrder order : {SearchOrder::kRuns, SearchOrder::kCurve}) {
      EXPECT_EQ(self_intersections(test::joined(mesh, strays(distance)), order).pairs, pairs) << distance;
    }
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
