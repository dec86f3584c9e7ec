// The gradient of the winding number, against differences of winding numbers and the sum over all triangles, both in
// 113-bit arithmetic.
#include "core/evaluation/gradient.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/exact/direct_gradient.h"
#include "core/exact/direct_sum.h"
#include "core/machine/threads.h"
#include "core/mesh/weld.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

GradientEvaluator evaluator_of(const TriangleMesh& mesh) { return {mesh, exterior_edges(mesh)}; }

std::vector<Vec3> gradients_of(const TriangleMesh& mesh, const std::vector<Vec3>& points) {
  std::vector<Vec3> values(points.size());
  evaluator_of(mesh).evaluate(points, values);
  return values;
}

TriangleMesh welded_soup(int seed, int triangles = 30) {
  test::Random random(static_cast<std::uint64_t>(seed));
  return weld(test::soup(random, triangles), {});
}

double component(const QuadVec3& v, int axis) { return static_cast<double>(axis == 0 ? v.x : axis == 1 ? v.y : v.z); }

// By central differences: the step leaves an error of the third derivative times its square, and is far above what 113
// bits lose.
QuadVec3 difference_quotient(const TriangleMesh& mesh, const Vec3& q) {
  const auto along = [&](int axis) {
    constexpr double kStep = 1e-9;
    Vec3 before = q, behind = q;
    before[axis] -= kStep;
    behind[axis] += kStep;
    const Quad change = perturbed_direct_sum(mesh, behind).value - perturbed_direct_sum(mesh, before).value;
    return change / (Quad(behind[axis]) - before[axis]);
  };
  return {along(0), along(1), along(2)};
}

// Where all edges count alike: what is added is what the evaluator promises 1e-12 of.
void expect_sums(const TriangleMesh& mesh, const std::vector<Vec3>& points) {
  const std::vector<Vec3> gradients = gradients_of(mesh, points);
  for (std::size_t n = 0; n < points.size(); ++n) {
    const DirectGradient expected = direct_gradient(mesh, points[n]);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(gradients[n][axis], component(expected.value, axis), 1e-12 * static_cast<double>(expected.magnitude))
          << points[n].x << ' ' << points[n].y << ' ' << points[n].z;
    }
  }
}

TEST(Gradient, IsTheLimitOfDifferencesOfWindingNumbers) {
  test::Random random(7);
  for (const TriangleMesh& mesh : {test::open_box(), welded_soup(3)}) {
    std::vector<Vec3> points;
    for (int n = 0; n < 100; ++n) points.push_back(test::uniform_point(random, {{-1, -1, -1}, {2, 2, 2}}));
    const std::vector<Vec3> gradients = gradients_of(mesh, points);
    for (std::size_t n = 0; n < points.size(); ++n) {
      const QuadVec3 expected = difference_quotient(mesh, points[n]);
      for (int axis = 0; axis < 3; ++axis) {
        // The third derivative is below 1e4 a hundredth away from edges; nearer points are rare.
        EXPECT_NEAR(gradients[n][axis], component(expected, axis), 1e-12) << n;
      }
    }
  }
}

// Beside, behind and on edges and vertices, at all distances.
std::vector<Vec3> points_beside_edges(const TriangleMesh& mesh, test::Random& random) {
  std::vector<Vec3> points;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 a = mesh.vertices[t[i]], b = mesh.vertices[t[(i + 1) % 3]];
      for (const double at : {-0.5, 0.0, 1e-12, 0.25, 0.5, 1.0, 1.5}) {
        const Vec3 foot = a + at * (b - a);
        const Vec3 aside = test::uniform_point(random, {{-1, -1, -1}, {1, 1, 1}});
        for (const double distance : {1e-15, 1e-9, 1e-4, 1e-2}) points.push_back(foot + distance * aside);
        points.push_back(foot);
      }
    }
  }
  return points;
}

TEST(Gradient, IsTheSumOverAllSidesOfTrianglesAlsoBesideThem) {
  test::Random random(11);
  for (const TriangleMesh& mesh : {welded_soup(5, 6), test::moved(welded_soup(9, 6), {1, 1, 1}, {100, -100, 50})}) {
    expect_sums(mesh, points_beside_edges(mesh, random));
  }
}

// Near the line of all sides of a needle, also beyond its ends: no other part hides what one loses.
TEST(Gradient, IsTheSumOverTheSidesOfANeedleNearItsLine) {
  test::Random random(13);
  const Box box{{-1, -1, -1}, {1, 1, 1}};
  for (int n = 0; n < 200; ++n) {
    const Vec3 along = test::uniform_point(random, box);
    const auto beside = [&](double at, double distance) {
      return at * along + distance * test::uniform_point(random, box);
    };
    const TriangleMesh mesh{{beside(0.0, 1e-7), beside(1.0, 1e-7), beside(0.5, 1e-7)}, {{0, 1, 2}}};
    const std::vector<Vec3> points{beside(-3.0, 1e-8), beside(0.3, 1e-6), beside(1.5, 1e-8), beside(1e3, 1e-5)};
    const std::vector<Vec3> gradients = gradients_of(mesh, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const DirectGradient expected = direct_gradient(mesh, points[i]);
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(gradients[i][axis], component(expected.value, axis),
                    1e-12 * static_cast<double>(expected.magnitude));
      }
    }
  }
}

// Off the line of a sliver's sides by roundings, beyond its ends: the sum over its sides must not lose them, either.
TEST(Gradient, IsTheSumOverTheSidesOfASliverNextToItsLine) {
  test::Random random(19);
  const Box box{{-1, -1, -1}, {1, 1, 1}};
  for (int n = 0; n < 100; ++n) {
    const Vec3 along = test::uniform_point(random, box);
    const TriangleMesh mesh{{{0, 0, 0}, 0.7 * along, along}, {{0, 1, 2}}};
    expect_sums(mesh, {1.7 * along, -0.3 * along, 3.1 * along, -1e3 * along});
  }
}

TEST(Gradient, OfAClosedMeshIsZero) {
  const std::vector<Vec3> points{{0.5, 0.5, 0.5}, {0, 0, 0}, {0.5, 0, 0}, {1e300, 0, -1e300}, {3, 1, 2}};
  for (const TriangleMesh& mesh : {test::box_mesh({0, 0, 0}, {1, 1, 1}), test::sphere(5), TriangleMesh{}}) {
    for (const Vec3& gradient : gradients_of(weld(mesh, {}), points)) EXPECT_EQ(gradient, (Vec3{0, 0, 0}));
  }
}

TEST(Gradient, InTheMiddleOfASquareHole) {
  const Vec3 gradient = gradients_of(test::open_box(), {{0.5, 0.5, 1.0}}).front();
  constexpr double kPi = 3.14159265358979323846;
  EXPECT_NEAR(gradient.x, 0.0, 1e-15);
  EXPECT_NEAR(gradient.y, 0.0, 1e-15);
  // The field of a square loop of side 1 at its middle is 8 sqrt(2) / (4 pi); w falls on the way out.
  EXPECT_NEAR(gradient.z, -8 * std::sqrt(2.0) / (4 * kPi), 1e-15);
}

TEST(Gradient, OnTheLineOfAnEdgeThatEdgeAddsNothing) {
  const TriangleMesh mesh = weld({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{{0, 1, 2}}}}, {});
  const auto without = [&](const Vec3& q) {
    std::vector<ExteriorEdge> others = exterior_edges(mesh);
    std::erase_if(
        others, [&](const ExteriorEdge& e) { return mesh.vertices[e.from].y == 0.0 && mesh.vertices[e.to].y == 0.0; });
    Vec3 value;
    GradientEvaluator(mesh, others).evaluate(std::vector<Vec3>{q}, {&value, 1});
    return value;
  };
  for (const Vec3& q : {Vec3{0.5, 0, 0}, Vec3{2, 0, 0}, Vec3{-1e-200, 0, 0}}) {
    const Vec3 gradient = gradients_of(mesh, {q}).front();
    EXPECT_EQ(gradient, without(q));
    EXPECT_TRUE(std::isfinite(gradient.z));
  }
}

// Coordinates of such queries have other magnitudes than the edge's: no difference of the two fits 113 bits.
TEST(Gradient, NextToASkewEdgeIsThatOfItsLine) {
  const Vec3 from{-0.25, -0.75, 0}, to{0.25, 0.75, 0};
  const TriangleMesh mesh = weld({{from, to, {0, 0, 1}}, {{{0, 1, 2}}}}, {});
  const auto of_edge = [&](const Vec3& q) {
    std::vector<ExteriorEdge> edges = exterior_edges(mesh);
    std::erase_if(edges, [&](const ExteriorEdge& e) { return mesh.vertices[e.from].z + mesh.vertices[e.to].z != 0.0; });
    Vec3 value;
    GradientEvaluator(mesh, edges).evaluate(std::vector<Vec3>{q}, {&value, 1});
    return value;
  };
  const auto defined = [&](const Vec3& q) {
    const TriangleMesh flat = weld({{from, to, from}, {{{0, 1, 2}}}}, {});  // whose sides cancel
    EXPECT_EQ(component(direct_gradient(flat, q).value, 2), 0.0);
    return component(direct_gradient(mesh, q).value, 2);
  };
  for (const double scale : {0x1p-115, 0x1p-130, 0x1p-1000}) {
    EXPECT_EQ(of_edge({scale, 3 * scale, 0}), Vec3{}) << scale;
    EXPECT_LT(std::abs(defined({scale, 3 * scale, 0})), 10.0) << scale;
  }
  // From a point so near to its middle the edge is a line: 1 / (2 pi d).
  for (const double scale : {1e-20, 0x1p-115, 1e-40, 1e-300}) {
    const double expected = std::sqrt(10.0) / (2 * std::numbers::pi * scale);
    EXPECT_NEAR(std::abs(of_edge({scale, 2 * scale, 0}).z), expected, 1e-12 * expected) << scale;
    EXPECT_NEAR(std::abs(defined({scale, 2 * scale, 0})), expected, 1e-12 * expected) << scale;
  }
}

// Parts that no double holds may cancel.
TEST(Gradient, NextToACornerIsTheSumOfPartsBeyondDoubles) {
  const Vec3 q{0, 0, 2e-311};
  const TriangleMesh mesh = weld({{{0, 0, 0}, {1, 1, 0}, {1.001, 1, 0}}, {{{0, 1, 2}}}}, {});
  const Vec3 gradient = gradients_of(mesh, {q}).front();
  const DirectGradient expected = direct_gradient(mesh, q);
  for (const int axis : {0, 1}) {
    EXPECT_GT(std::abs(gradient[axis]), 1e306);
    EXPECT_NEAR(gradient[axis] / component(expected.value, axis), 1.0, 1e-12);
  }
}

// Parts that doubles hold with few bits do not cancel.
TEST(Gradient, OfATinyMeshFarAwayIsNothing) {
  const double h = 1e-290;
  const TriangleMesh mesh = weld({{{h, 2 * h, 3 * h}, {5 * h, h, 2 * h}, {3 * h, 7 * h, h}}, {{{0, 1, 2}}}}, {});
  for (const Vec3& q : {Vec3{-2.08e-133, 7.13e-133, -2.04e-133}, Vec3{1e-140, 0, 2e-150}, Vec3{3e-130, 1e-131, 0}}) {
    const Vec3 gradient = gradients_of(mesh, {q}).front();
    const DirectGradient expected = direct_gradient(mesh, q);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(gradient[axis], component(expected.value, axis), 1e-12 * static_cast<double>(expected.magnitude));
    }
  }
}

// From far away the ends of an edge are in one place, even in 113 bits.
TEST(Gradient, FarAwayIsNothingAndNotNothingOverNothing) {
  // The side from the second to the third corner of a triangle is across some of the directions.
  const TriangleMesh triangle{{{0, 0, 0}, {0.3, 0, 0}, {0, 0.3, 0}}, {{{0, 1, 2}}}};
  for (const TriangleMesh& mesh : {test::open_box(), weld(triangle, {})}) {
    for (const double far : {1e20, 1e25, 1e30, 1e34, 1e35, 1e60, 1e150, 1e300}) {
      for (const Vec3& direction : {Vec3{1, 1, 1}, Vec3{-1, 1, 0}, Vec3{0, 0, 1}, Vec3{0.3, -0.2, 0.7}}) {
        const Vec3 q = far * direction;
        const Vec3 gradient = gradients_of(mesh, {q}).front();
        const DirectGradient expected = direct_gradient(mesh, q);
        for (int axis = 0; axis < 3; ++axis) {
          const auto component_of = static_cast<double>(component(expected.value, axis));
          EXPECT_TRUE(std::isfinite(component_of)) << far;
          EXPECT_NEAR(gradient[axis], component_of, 1e-12 * static_cast<double>(expected.magnitude)) << far;
        }
      }
    }
  }
}

// Where parts are beyond doubles it is their sizes that rounding is judged by.
TEST(Gradient, OfATriangleOfTheLeastNumbersIsThatOfTheDefinition) {
  const double least = 5e-324;
  const TriangleMesh mesh = weld({{{0, 0, 0}, {least, 0, 0}, {0, least, 0}}, {{{0, 1, 2}}}}, {});
  const Vec3 q{1e-320, 1e-320, 1e-320};
  const Vec3 gradient = gradients_of(mesh, {q}).front();
  const DirectGradient expected = direct_gradient(mesh, q);
  EXPECT_GT(expected.magnitude, Quad(1e308));
  const Quad off = component(expected.value, 2) - Quad(gradient.z);
  EXPECT_LT((off < 0 ? -off : off) / expected.magnitude, Quad(1e-12));
}

TEST(Gradient, ScalesWithTheMeshAtAllMagnitudes) {
  const TriangleMesh mesh = welded_soup(2);
  const std::vector<Vec3> points{{0.3, 0.4, 0.6}, {-2, 5, 1}};
  const std::vector<Vec3> expected = gradients_of(mesh, points);
  for (const int exponent : {-900, -300, 1, 300, 900}) {
    const double s = std::ldexp(1.0, exponent);
    const std::vector<Vec3> scaled =
        gradients_of(test::moved(mesh, {s, s, s}, {0, 0, 0}), {s * points[0], s * points[1]});
    for (std::size_t n = 0; n < points.size(); ++n) EXPECT_EQ(s * scaled[n], expected[n]) << exponent;
  }
}

TEST(Gradient, IsFiniteEverywhere) {
  const TriangleMesh mesh = weld({{{0, 0, 0}, {1e-300, 0, 0}, {0, 1e300, 0}, {5e-324, 1, 0}, {0, 0, 1e-310}},
                                  {{{0, 1, 2}}, {{0, 3, 4}}, {{1, 2, 4}}}},
                                 {});
  std::vector<Vec3> points;
  const std::array values{0.0, -0.0, 5e-324, -1e-310, 1e-160, 1.0, 1e154, -1e300, 1.7e308};
  for (const double x : values) {
    for (const double y : values) {
      for (const double z : values) points.push_back({x, y, z});
    }
  }
  for (const Vec3& g : gradients_of(mesh, points)) {
    EXPECT_TRUE(std::isfinite(g.x) && std::isfinite(g.y) && std::isfinite(g.z));
  }
}

TEST(Gradient, OfALatticeIsThatAtItsPointsForAnyThreads) {
  const TriangleMesh mesh = welded_soup(4);
  const Lattice lattice{{-0.5, -0.25, 0.1}, {0.1, 0.2, 0.3}, {-3, 1, 2}, {13, 7, 5}};
  const LatticeBlock block{{-2, 2, 3}, {11, 5, 3}};
  std::vector<Vec3> points, values(static_cast<std::size_t>(block.size()));
  for (std::size_t n = 0; n < values.size(); ++n) points.push_back(lattice.position(block.index_of(n)));
  EXPECT_EQ(points[12], (Vec3{lattice.coordinate(0, -1), lattice.coordinate(1, 3), lattice.coordinate(2, 3)}));
  evaluator_of(mesh).evaluate(lattice, block, values);
  const ThreadLimit one(1);
  EXPECT_EQ(values, gradients_of(mesh, points));
}

TEST(Gradient, IsTheSameForEveryLevelOfSimd) {
  test::Random random(3);
  const TriangleMesh mesh = test::joined(test::open_box(), welded_soup(6, 40));
  std::vector<Vec3> points = points_beside_edges(test::open_box(), random);
  for (int n = 0; n < 500; ++n) points.push_back(test::uniform_point(random, {{-1, -1, -1}, {2, 2, 2}}));
  std::vector<Vec3> expected(points.size());
  GradientEvaluator(mesh, exterior_edges(mesh), SimdLevel::kSse4).evaluate(points, expected);
  for (const SimdLevel level : {SimdLevel::kAvx2, SimdLevel::kAvx512}) {
    std::vector<Vec3> values(points.size());
    GradientEvaluator(mesh, exterior_edges(mesh), level).evaluate(points, values);
    EXPECT_EQ(values, expected);
  }
}

// Numbers that would become subnormal, or 0, in the scale of the mesh.
TEST(Gradient, NextToAVertexOfAHugeMesh) {
  for (const double size : {1e10, 1e40, 1e200}) {
    const TriangleMesh mesh{{{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}}, {{0, 1, 2}, {0, 3, 1}}};
    std::vector<Vec3> points;
    for (const double small : {1e-290, 1e-200, 1e-100, 1.0}) {
      for (const Vec3& direction : {Vec3{1, 2, 1}, Vec3{-1, 0.5, 3}, Vec3{0.25, 0, 1}}) {
        points.push_back(small * direction);
      }
    }
    expect_sums(mesh, points);
  }
}

// Products of four lengths have few bits there, which nothing tells afterwards.
TEST(Gradient, NextToASmallPartOfAMesh) {
  for (const double small : {0x1p-240, 0x1p-258, 0x1p-266}) {
    const TriangleMesh mesh{{{small, 0, 0}, {0, small, 0}, {0, 0, small}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                            {{0, 1, 2}, {3, 4, 5}}};
    expect_sums(mesh, {small * Vec3{0.3, 0.2, 0.7}, small * Vec3{-1, 0.5, 3}, small * Vec3{0.6, 0.5, -0.2}});
  }
}

}  // namespace
}  // namespace raycone
