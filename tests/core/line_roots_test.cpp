#include "core/cells/line_roots.h"

#include <gtest/gtest.h>

#include <optional>

#include "core/evaluation/winding_number.h"
#include "core/exact/direct_sum.h"
#include "core/machine/floating_point.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

constexpr double kFirst = 0x1p-6, kBehind = 0x1p-10;

// Of the unit cube without its top, from a point along a direction.
std::optional<Vec3> root_from(const Vec3& point, const Vec3& direction, double reach, const Rule& rule = {}) {
  const DefaultFloatingPoint guard;
  const TriangleMesh mesh = test::open_box();
  const WindingNumberEvaluator evaluator(mesh);
  return nearest_roots({line_through(point, direction, reach)}, kFirst, kBehind, RuleAlong(evaluator, rule)).front();
}

TEST(LineRoots, AreWhereTheWindingNumberIsTheThreshold) {
  for (const Vec3& point : {Vec3{0.4, 0.3, 0.8}, Vec3{0.4, 0.3, 1.2}, Vec3{0.1, 0.2, 0.9}}) {
    const std::optional<Vec3> root = root_from(point, {0.1, 0.05, 1.0}, 0.5);
    ASSERT_TRUE(root);
    const double w = static_cast<double>(perturbed_direct_sum(test::open_box(), *root).value);
    EXPECT_NEAR(w, 0.5, 1e-9);  // 2^-34 of a search of 0.25 at most, where w changes by a few turns a unit
  }
}

// From inside and from outside, along either way of the line, and obliquely.
TEST(LineRoots, AreBehindTheFacesThatTheyAreAt) {
  for (const double from : {0.1, -0.1}) {
    for (const double way : {1.0, -1.0}) {
      const std::optional<Vec3> root = root_from({from, 0.3, 0.2}, {way, 0.0, 0.0}, 0.2);
      ASSERT_TRUE(root);
      EXPECT_NEAR(root->x, kBehind, 1e-10);  // 2^-34 of the search, and what it rounds
    }
  }
  const std::optional<Vec3> root = root_from({-0.1, 0.3, 0.2}, {3.0, 4.0, 0.0}, 0.4);
  ASSERT_TRUE(root);
  EXPECT_NEAR(root->x, 0.6 * kBehind, 1e-10);
}

// w is 0.7 inside, so -0.3 outside, and both are 0.2 from a threshold.
TEST(LineRoots, AreBehindFacesByRulesThatFoldToo) {
  for (const RuleKind kind : {RuleKind::kNonzero, RuleKind::kOdd, RuleKind::kAbs}) {
    const std::optional<Vec3> root = root_from({-0.1, 0.5, 0.8}, {1.0, 0.0, 0.0}, 0.2, {kind, 0.5});
    ASSERT_TRUE(root);
    EXPECT_NEAR(root->x, kBehind, 1e-10);
  }
}

// A place inside that is nearer than twice as far is half as near: there may be another face between them.
TEST(LineRoots, AreNotFartherBehindThanHalfOfTheWay) {
  const std::optional<Vec3> root = root_from({0x1p-12, 0.3, 0.2}, {1.0, 0.0, 0.0}, 0.2);
  ASSERT_TRUE(root);
  EXPECT_NEAR(root->x, 0x1p-13, 1e-10);
}

TEST(LineRoots, AreNowhereOnLinesOnOneSide) {
  EXPECT_FALSE(root_from({0.5, 0.5, 0.2}, {1.0, 0.0, 0.0}, 0.3));
  EXPECT_FALSE(root_from({-0.5, 0.5, 0.2}, {0.0, 1.0, 0.0}, 0.3));
  EXPECT_FALSE(root_from({0.1, 0.5, 0.2}, {0.0, 0.0, 0.0}, 0.3));
}

}  // namespace
}  // namespace raycone
