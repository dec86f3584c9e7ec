#include "core/cells/edge_roots.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "tests/support/shapes.h"
#include "tests/support/values.h"

namespace raycone {
namespace {

using test::Random;
using test::uniform;

constexpr double kNarrow = 0x1p-34;
constexpr double kNothing = 0x1p-60;  // far less than winding numbers are off by

// The number of values that it took to find the root of f along an edge of length 1.
std::size_t values_for(const std::function<double(double)>& f, double root) {
  std::vector<Bracket> brackets{{{{0, 0, 0}, {1, 0, 0}, 0}, 0.0, 1.0}};
  std::size_t count = 0;
  find_roots(brackets, [&](const std::vector<Vec3>& places) {
    std::vector<double> values;
    for (const Vec3& p : places) values.push_back(f(p.x));
    count += places.size();
    return values;
  });
  const double off = std::abs(brackets[0].root - root), value = f(brackets[0].root);
  EXPECT_TRUE(off <= kNarrow || (value != 0.0 && std::abs(value) < kNothing)) << off;
  EXPECT_LE(brackets[0].low, root);
  EXPECT_GE(brackets[0].high, root);
  EXPECT_LE(brackets[0].low, brackets[0].root);
  EXPECT_GE(brackets[0].high, brackets[0].root);
  return count;
}

// As winding numbers are along an edge: nearly straight, or with a bend where a boundary edge is near.
TEST(EdgeRoots, AreFoundInFewValues) {
  Random random(5);
  std::size_t straight = 0, bent = 0;
  constexpr std::size_t kCount = 200;
  for (std::size_t n = 0; n < kCount; ++n) {
    const double root = uniform(random, 0.02, 0.98), slope = std::exp(uniform(random, -12.0, 0.0));
    const double curve = uniform(random, -0.4, 0.4), steep = uniform(random, 1.0, 30.0);
    straight += values_for([&](double x) { return slope * (root - x) * (1 + curve * (root - x)); }, root);
    bent += values_for([&](double x) { return slope * std::atan(steep * (root - x)); }, root);
  }
  EXPECT_LT(straight, 7 * kCount);
  EXPECT_LT(bent, 11 * kCount);
}

// Where w is steep, next to a boundary edge, a bracket's middle would not do.
TEST(EdgeRoots, AreNearlyExactWhereValuesAreSmooth) {
  for (const double steep : {1.0, 1e3, 1e5}) {
    const double root = 0.3141592653589793;
    std::vector<Bracket> brackets{{{{0, 0, 0}, {1, 0, 0}, 0}, 0.0, 1.0}};
    find_roots(brackets, [&](const std::vector<Vec3>& places) {
      std::vector<double> values;
      for (const Vec3& p : places) values.push_back(std::atan(steep * (root - p.x)));
      return values;
    });
    EXPECT_NEAR(brackets[0].root, root, 1e-15);  // some roundings of the place
  }
}

TEST(EdgeRoots, OfNarrowBracketsAreInTheMiddle) {
  std::vector<Bracket> brackets{{{{0, 0, 0}, {1, 0, 0}, 0}, 0.5, 0.5 + 0x1p-36}};
  find_roots(brackets, [](const std::vector<Vec3>& places) { return std::vector<double>(places.size(), 0.0); });
  EXPECT_EQ(brackets[0].root, 0.5 + 0x1p-37);
}

TEST(EdgeRoots, AskOnceForAnEndOfSeveralEdges) {
  const Vec3 node{0, 0, 0};
  std::vector<Bracket> brackets{{{node, {1, 0, 0}, 0}, 0.0, 1.0}, {{node, {0, 1, 0}, 1}, 0.0, 1.0}};
  brackets.push_back({{{1, 1, 0}, {0, 1, 0}, 2}, 0.0, 1.0});
  std::vector<std::size_t> asked;
  find_roots(brackets, [&](const std::vector<Vec3>& places) {
    asked.push_back(places.size());
    std::vector<double> values;
    for (const Vec3& p : places) values.push_back(0.25 - p.x - p.y + 2.0 * p.x * p.y);
    return values;
  });
  EXPECT_EQ(asked[0], 4U);
  for (const Bracket& bracket : brackets) EXPECT_NEAR(bracket.root, 0.25, 1e-15);  // some roundings of the place
}

// Halving finds what interpolation does not.
TEST(EdgeRoots, AreFoundOfAnyFunction) {
  const double root = 0.3141592653589793;
  const auto from = [&](double x) { return root - x; };
  EXPECT_LT(values_for([&](double x) { return from(x) >= 0 ? 1.0 : -1.0; }, root), 80U);
  EXPECT_LT(values_for([&](double x) { return from(x) >= 0 ? 1e-12 : -1e3; }, root), 80U);
  EXPECT_LT(values_for([&](double x) { return std::pow(from(x), 9); }, root), 80U);
  EXPECT_LT(values_for([&](double x) { return std::copysign(std::sqrt(std::abs(from(x))), from(x)); }, root), 80U);
  EXPECT_LT(values_for([&](double x) { return from(x) >= 0 ? 0.0 : -0.1; }, root), 80U);
}

// Not where one end is far from 0, and values reach it smoothly from the other one.
TEST(EdgeRoots, TellJumps) {
  const double root = 0.3141592653589793;
  const auto is_jump = [&](const auto& f) {
    std::vector<Bracket> brackets{{{{0, 0, 0}, {1, 0, 0}, 0}, 0.0, 1.0}};
    find_roots(brackets, [&](const std::vector<Vec3>& places) {
      std::vector<double> values;
      for (const Vec3& p : places) values.push_back(f(p.x));
      return values;
    });
    return brackets[0].at_jump;
  };
  for (const double jump : {1.0, 0.4, 0.01}) {
    EXPECT_TRUE(is_jump([&](double x) { return (root - x) / 10 + (x < root ? 0.5 : -0.5) * jump; })) << jump;
  }
  for (const double scale : {0.1, 1.0, 100.0}) {
    EXPECT_FALSE(is_jump([&](double x) { return scale * (root - x); })) << scale;
    EXPECT_FALSE(is_jump([&](double x) { return std::atan(scale * (root - x)); })) << scale;
    EXPECT_FALSE(is_jump([&](double x) { return std::expm1(scale * (root - x)); })) << scale;
  }
}

// At triangles values may be those of their other side.
TEST(EdgeRoots, MayHaveWrongValuesAtTheEnds) {
  const double root = 0.7;
  const auto f = [&](double x) { return x == 0.0 ? -0.5 : x == 1.0 ? 0.5 : 0.01 * (root - x); };
  EXPECT_LT(values_for(f, root), 20U);
}

// A far field that is off by more than w at these places is from a threshold.
TEST(RuleAlong, HoldsAsItDoesWhateverTheTolerance) {
  Random random(11);
  TriangleMesh mesh = test::sphere(16);
  std::erase_if(mesh.triangles, [&](const Triangle&) { return random() % 3 != 0; });
  const WindingNumberEvaluator exact(mesh);
  const WindingNumberEvaluator rough(mesh, {.summation = Summation::kFarField, .accuracy = {.tolerance = 1e-2}});
  for (const Rule& rule : {Rule{RuleKind::kThreshold, 0.3}, Rule{RuleKind::kAbs, 0.25}, Rule{RuleKind::kOdd, 0.5}}) {
    const RuleAlong along(exact, rule);
    std::vector<Vec3> points;
    for (int n = 0; n < 40; ++n) {
      Vec3 low = test::uniform_point(random, {{-2, -2, -2}, {2, 2, 2}});
      Vec3 high = test::uniform_point(random, {{-2, -2, -2}, {2, 2, 2}});
      for (int halves = 0; halves < 30; ++halves) {
        const std::vector<std::uint8_t> ends = along.holds_at({low, 0.5 * low + 0.5 * high});
        (ends[0] == ends[1] ? low : high) = 0.5 * low + 0.5 * high;
      }
      points.insert(points.end(), {low, high});
    }
    const std::vector<double> w = test::values_of(exact, points);
    const std::vector<std::uint8_t> found = RuleAlong(rough, rule).holds_at(points);
    for (std::size_t n = 0; n < points.size(); ++n) EXPECT_EQ(found[n] != 0, holds(rule, w[n])) << w[n];
  }
}

}  // namespace
}  // namespace raycone
