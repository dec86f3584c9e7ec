// Values next to exterior edges: the error stays below 1e-12 down to 1e-300 of an edge's length.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "core/evaluation/winding_number.h"
#include "core/mesh/weld.h"
#include "tests/property/check.h"
#include "tests/support/diagnosed.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::Random;

constexpr double kPromised = 1e-12;
constexpr std::array<double, 12> kDistances{1e-3,  1e-6,   1e-9,   1e-12,  1e-15,  1e-30,
                                            1e-60, 1e-100, 1e-150, 1e-200, 1e-250, 1e-300};

// Edges of a length about 1 through the origin: parallel to each axis, in each coordinate plane, oblique.
constexpr std::array<Vec3, 8> kDirections{{{1, 0, 0},
                                           {0, 1, 0},
                                           {0, 0, 1},
                                           {0.5, 0.75, 0},
                                           {0.25, 0, -1},
                                           {0, 0.5, 1},
                                           {0.5, -0.25, 0.75},
                                           {-1, 0.125, 0.25}}};

// Triangles on the edge from -below * d to above * d, all in one direction: its multiplicity is their number.
TriangleMesh book(const Vec3& d, double below, double above, int pages, Random& random) {
  TriangleMesh mesh;
  for (int i = 0; i < pages; ++i) {
    const Vec3 tip = test::uniform_point(random, {{-1, -1, -1}, {1, 1, 1}});
    test::add_triangle(mesh, -below * d, above * d, tip);
  }
  return weld(mesh, {});
}

// All directions: random ones, and those along the axes and the edge, where ties are.
std::vector<Vec3> around_origin(const Vec3& d, double distance, Random& random) {
  std::vector<Vec3> queries;
  for (int i = 0; i < 6; ++i) queries.push_back(distance * test::uniform_point(random, {{-1, -1, -1}, {1, 1, 1}}));
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Vec3 q;
      q[axis] = side * distance;
      queries.push_back(q);
    }
  }
  queries.push_back(distance * d);
  queries.push_back(-distance * d);
  return queries;
}

// The error is at most the bound, by the check; and the bound is what was promised.
void expect_twelve_digits(const TriangleMesh& mesh, const std::vector<Vec3>& queries) {
  const auto failure = test::check(mesh, queries);
  ASSERT_FALSE(failure) << test::describe(mesh, *failure);
  EXPECT_LT(std::ranges::max(test::diagnosed(WindingNumberEvaluator(mesh), queries).bounds), kPromised);
}

// `below` 0: the queries are around the edge's first vertex; below and above 0.5: around its inside.
void check_distances(double below, double above) {
  Random random(1);
  for (const Vec3& d : kDirections) {
    for (int pages = 1; pages <= 3; ++pages) {
      const TriangleMesh mesh = book(d, below, above, pages, random);
      for (const double distance : kDistances) expect_twelve_digits(mesh, around_origin(d, distance, random));
    }
  }
}

TEST(ExteriorEdgeDistance, FromTheInsideKeepsTwelveDigits) { check_distances(0.25, 0.75); }

TEST(ExteriorEdgeDistance, FromTheEndsKeepsTwelveDigits) {
  check_distances(0, 1);
  check_distances(1, 0);
}

// Edges that meet at the query's place: a whole boundary vertex, and edges of several meshes crossing there.
TEST(ExteriorEdgeDistance, FromManyEdgesAtOnceKeepsTwelveDigits) {
  Random random(2);
  TriangleMesh mesh;
  for (const Vec3& d : kDirections) {
    const TriangleMesh one = book(d, 0.5, 0.25, 1, random);
    mesh = mesh.triangles.empty() ? one : test::joined(mesh, one);
  }
  for (const double distance : kDistances) expect_twelve_digits(mesh, around_origin({0.5, 1, 0.25}, distance, random));
}

// Edges whose projection along the ray is far shorter than they are, and edges at which the ray arrives flat.
TEST(ExteriorEdgeDistance, OfEdgesNearlyParallelToTheRayKeepsTwelveDigits) {
  Random random(3);
  for (const double slope : {1e-3, 1e-8, 1e-17, 1e-100, 1e-300}) {
    for (const Vec3& d : {Vec3{1, slope, 0}, Vec3{1, 0, -slope}, Vec3{-1, slope, 2 * slope}}) {
      const TriangleMesh mesh = book(d, 0.5, 0.5, 2, random);
      for (const double distance : {1e-3, 1e-12, 1e-60}) {
        expect_twelve_digits(mesh, around_origin(d, distance, random));
      }
    }
  }
}

}  // namespace
}  // namespace raycone
