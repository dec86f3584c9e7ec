#include "core/surface/edge_roots.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/machine/floating_point.h"
#include "core/surface/edge_crossing.h"
#include "tests/support/shapes.h"

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

// Integers below 2^53: the ends are a few units from the plane, times the normal's length, which is 2^102. They were
// made by extended Euclid.
struct NearPlane {
  std::array<Vec3, 5> points;  // the triangle, and the segment's ends
  double at;
};
const std::array kNearPlanes{
    NearPlane{{{{-2602258250006602, 1945105548177019, -1249914251404426},
                {931029837885614, -2054786193315149, -1267997258479291},
                {1671228412120988, 109680645138130, 2517911509883717},
                {-567493322440092, 182375257459227, -577791810677654},
                {160380232180817, -451932101805160, -342088889388341}}},
              2.0 / 3},
    NearPlane{{{{6431330984513, 691886611335235, 4215872122113501},
                {6254322637260755, -4523262273640865, -1921658404533798},
                {-6260753968245268, 3831375662305630, -2294213717579703},
                {-1285992144330063, 840921260009285, -144635094155592},
                {782665341466791, -425510628788914, 610495691578839}}},
              100.0 / 117},
    NearPlane{{{{-1427546070851317, -731132088316662, 142676961843506},
                {-188226475480816, 4213178900257989, -979171615995316},
                {1615772546332133, -3482046811941327, 836494654151810},
                {-521630878201291, -32139155233682, -2289497710301},
                {137346563752556, -634714622615616, 149545454974409}}},
              1.0 / 4},
    NearPlane{{{{-805847324991452, -127898668752509, 2449415547507540},
                {-2999436072989078, 3195690063046723, -2717917812840543},
                {3805283397980530, -3067791394294214, 268502265333003},
                {87905567764134, 23697660966699, -298606830654067},
                {323952150587965, -207263119777208, -150889079491177}}},
              100.0 / 117},
};

// Where both ends lie next to the plane their distances cancel in 113 bits.
TEST(EdgeCrossing, PlacesAreRightWhereBothEndsAreNextToThePlane) {
  const DefaultFloatingPoint guard;
  for (const auto& [points, expected] : kNearPlanes) {
    const auto& [a, b, c, p, q] = points;
    const std::optional<double> at = segment_hit(p, q, a, b, c);
    ASSERT_TRUE(at);
    EXPECT_NEAR(*at, expected, 1e-15);
    const TriangleMesh mesh{{a, b, c}, {{0, 1, 2}}};
    HitFinder finder(mesh);
    finder.enter(p, std::vector<std::uint32_t>{0});
    std::vector<SegmentHit> hits;
    finder.find(q, true, hits);
    ASSERT_EQ(hits.size(), 1U);
    EXPECT_EQ(hits[0].at, *at);
  }
}

// And where products of lengths underflow.
TEST(EdgeCrossing, PlacesAreThoseOfAnyScale) {
  const DefaultFloatingPoint guard;
  Random random(7);
  int hit = 0;
  for (int n = 0; n < 2000; ++n) {
    std::array<Vec3, 5> points;
    for (Vec3& v : points) v = {uniform(random, -1, 1), uniform(random, -1, 1), 1e-6 * uniform(random, -1, 1)};
    const auto at_scale = [&](double s) {
      return segment_hit(s * points[3], s * points[4], s * points[0], s * points[1], s * points[2]);
    };
    const std::optional<double> at = at_scale(1.0);
    hit += at ? 1 : 0;
    for (const double s : {0x1p-200, 0x1p-345, 0x1p-358, 0x1p-362, 0x1p300}) {
      const std::optional<double> scaled = at_scale(s);
      ASSERT_EQ(at.has_value(), scaled.has_value()) << s;
      EXPECT_NEAR(at.value_or(0.0), scaled.value_or(0.0), 1e-15) << s;
    }
  }
  EXPECT_GT(hit, 100);
}

// Jumps are what a triangle changes in w, as sums of solid angles on both sides tell.
TEST(EdgeCrossing, JumpsAreThoseOfTheWindingNumber) {
  Random random(6);
  int known = 0;
  const auto point = [&] { return Vec3{uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)}; };
  for (int n = 0; n < 400; ++n) {
    const TriangleMesh mesh{{point(), point(), point()}, {{0, 1, 2}}};
    const WindingNumberEvaluator evaluator(mesh);
    const Vec3 end = point(), other = point();
    HitFinder finder(mesh);
    finder.enter(end, std::vector<std::uint32_t>{0});
    for (const bool from_end : {true, false}) {
      std::vector<SegmentHit> hits;
      finder.find(other, from_end, hits);
      if (hits.empty()) continue;
      ASSERT_EQ(hits.size(), 1U);
      const Vec3 &p = from_end ? end : other, &q = from_end ? other : end;
      constexpr double kStep = 0x1p-20;
      const std::vector<Vec3> places{p + (hits[0].at - kStep) * (q - p), p + (hits[0].at + kStep) * (q - p)};
      std::vector<double> w(2);
      evaluator.evaluate(places, w);
      EXPECT_EQ(std::round(w[1] - w[0]), hits[0].jump);
      ++known;
    }
  }
  EXPECT_GT(known, 30);
}

// Through a side, or to a point of the plane, nobody knows.
TEST(EdgeCrossing, JumpsAreNotKnownAtSides) {
  const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  HitFinder finder(mesh);
  const auto jump = [&](const Vec3& end, const Vec3& other) {
    finder.enter(end, std::vector<std::uint32_t>{0});
    std::vector<SegmentHit> hits;
    finder.find(other, true, hits);
    return hits.empty() ? 99 : int{hits[0].jump};
  };
  EXPECT_EQ(jump({0.25, 0.25, -1}, {0.25, 0.25, 1}), -1);  // to its front, where w is less
  EXPECT_EQ(jump({0.25, 0.25, 1}, {0.25, 0.25, -1}), 1);
  EXPECT_EQ(jump({0.5, 0.0, -1}, {0.5, 0.0, 1}), 0);
  EXPECT_EQ(jump({0.0, 0.0, -1}, {0.0, 0.0, 1}), 0);
  EXPECT_EQ(jump({0.25, 0.25, 0}, {0.25, 0.25, 1}), 0);
  EXPECT_EQ(jump({2.0, 2.0, -1}, {2.0, 2.0, 1}), 99);
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
    std::vector<double> w(points.size());
    exact.evaluate(points, w);
    const std::vector<std::uint8_t> found = RuleAlong(rough, rule).holds_at(points);
    for (std::size_t n = 0; n < points.size(); ++n) EXPECT_EQ(found[n] != 0, holds(rule, w[n])) << w[n];
  }
}

}  // namespace
}  // namespace raycone
