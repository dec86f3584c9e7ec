#include "core/arrangement/rule_border.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "core/arrangement/arrangement.h"
#include "core/distance/distance.h"
#include "core/evaluation/winding_number.h"
#include "core/mesh/exterior_edges.h"
#include "core/mesh/weld.h"
#include "tests/support/border_sources.h"
#include "tests/support/shapes.h"
#include "tests/support/values.h"

namespace raycone {
namespace {

constexpr std::size_t kAll = 1 << 20;

const std::vector<Rule> kBorderRules{{},
                                     {RuleKind::kThreshold, 1.5},
                                     {RuleKind::kThreshold, -0.5},
                                     {RuleKind::kAbs, 2.0},
                                     {RuleKind::kNonzero},
                                     {RuleKind::kPositive},
                                     {RuleKind::kOdd}};

std::vector<double> windings(const TriangleMesh& mesh, const std::vector<Vec3>& points) {
  return test::values_of(WindingNumberEvaluator(mesh), points);
}

// Points in and around the box of the mesh that are so far from it that rounding of corners cannot pass them.
std::vector<Vec3> points_off(const TriangleMesh& mesh, test::Random& random, int count) {
  Box box = bounding_box(mesh);
  const Vec3 margin = 0.1 * (box.upper - box.lower);
  box = {box.lower - margin, box.upper + margin};
  const DistanceEvaluator distance(mesh);
  std::vector<Vec3> points;
  while (points.size() < static_cast<std::size_t>(count)) {
    const std::array point{test::uniform_point(random, box)};
    std::array<double, 1> off{};
    distance.evaluate(point, off);
    if (off[0] > 1e-9 * norm(margin)) points.push_back(point[0]);
  }
  return points;
}

// Whether the border goes once around the points for which the rule holds, and around no others: none of the points is
// on the wrong side, counted.
int wrong_points(const TriangleMesh& mesh, const Rule& rule, test::Random& random, int count) {
  const std::optional<RuleBorder> border = rule_border(mesh, {rule, CoordinatePrecision::kDouble, kAll});
  EXPECT_TRUE(border);
  if (!border) return count;
  EXPECT_TRUE(exterior_edges(border->mesh).empty());
  EXPECT_EQ(border->sources.size(), border->mesh.triangles.size());
  EXPECT_LE(test::farthest_from_source(*border, mesh), 1e-12);  // corners are rounded
  const std::vector<Vec3> points = points_off(mesh, random, count);
  const std::vector<double> of_mesh = windings(mesh, points), of_border = windings(border->mesh, points);
  const double around_all = holds(rule, 0.0) ? 1.0 : 0.0;  // the rule holds far away, too
  int wrong = 0;
  for (std::size_t n = 0; n < points.size(); ++n) {
    wrong += of_border[n] + around_all == (holds(rule, of_mesh[n]) ? 1.0 : 0.0) ? 0 : 1;
  }
  return wrong;
}

// A tetrahedron with corners in {0 .. size}^3, either way around.
TriangleMesh lattice_tetrahedron(test::Random& random, int size) {
  TriangleMesh mesh{{}, {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}};
  for (int n = 0; n < 4; ++n) {
    const auto coordinate = [&] { return std::floor(test::uniform(random, 0.0, size + 1.0)); };
    const double x = coordinate(), y = coordinate(), z = coordinate();
    mesh.vertices.push_back({x, y, z});
  }
  return mesh;
}

TriangleMesh many(int count, const auto& make) {
  TriangleMesh mesh;
  for (int n = 0; n < count; ++n) mesh = test::joined(mesh, make());
  return weld(mesh, {});
}

// Faces meet in every way there is: in planes, edges and corners of each other, twice, and both ways around.
TEST(RuleBorder, GoesAroundWhatTheRuleHoldsFor) {
  test::Random random(1);
  for (int round = 0; round < 150; ++round) {
    const int size = 1 + round % 4, count = 1 + round % 9;
    const TriangleMesh mesh = many(count, [&] { return lattice_tetrahedron(random, size); });
    for (const Rule& rule : kBorderRules) {
      EXPECT_EQ(wrong_points(mesh, rule, random, 20), 0) << round << " rule " << static_cast<int>(rule.kind);
    }
  }
}

TEST(RuleBorder, GoesAroundCellsThatShareSidesAndEdges) {
  test::Random random(2);
  for (int round = 0; round < 30; ++round) {
    const TriangleMesh mesh = test::joined(test::random_cells(random, 3), test::random_cells(random, 3));
    for (const Rule& rule : kBorderRules) {
      EXPECT_EQ(wrong_points(mesh, rule, random, 20), 0) << round << " rule " << static_cast<int>(rule.kind);
    }
  }
}

// The first ray from the base of a pyramid, from (89, 97, 0) on, meets the bottom of a roof, and its ridge.
TEST(RuleBorder, SendsAnotherRayWhereOneMeetsAnEdge) {
  const TriangleMesh pyramid{{{0, 0, 0}, {287, 0, 0}, {0, 287, 0}, {90, 90, -100}},
                             {{0, 1, 2}, {1, 0, 3}, {2, 1, 3}, {0, 2, 3}}};
  const TriangleMesh roof{{{60, 50, 10}, {120, 50, 10}, {120, 150, 10}, {60, 150, 10}, {89, 50, 30}, {89, 150, 30}},
                          {{0, 2, 1}, {0, 3, 2}, {0, 1, 4}, {2, 3, 5}, {1, 2, 5}, {1, 5, 4}, {3, 0, 4}, {3, 4, 5}}};
  test::Random random(4);
  EXPECT_EQ(wrong_points(test::joined(pyramid, roof), {}, random, 50), 0);
}

TEST(RuleBorder, GoesAroundSpheresThatMeet) {
  test::Random random(3);
  for (int round = 0; round < 20; ++round) {
    const TriangleMesh mesh = many(4, [&] {
      const double size = test::uniform(random, 0.2, 1.0);
      const Vec3 shift = test::uniform_point(random, {{-1, -1, -1}, {1, 1, 1}});
      return test::moved(test::sphere(7), {size, size, size}, shift);
    });
    for (const Rule& rule : {kBorderRules[0], kBorderRules[1], kBorderRules[6]}) {
      EXPECT_EQ(wrong_points(mesh, rule, random, 50), 0) << round << " rule " << static_cast<int>(rule.kind);
    }
  }
}

}  // namespace
}  // namespace raycone
