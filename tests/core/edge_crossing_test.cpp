// Where segments and edges of a lattice pass through triangles.
#include "core/cells/edge_crossing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/evaluation/winding_number.h"
#include "core/exact/quad.h"
#include "core/machine/floating_point.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::Random;
using test::uniform;

TEST(SegmentHit, IsExactAboutEnds) {
  const DefaultFloatingPoint guard;
  const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0};
  EXPECT_EQ(segment_hit({0.25, 0.25, -1}, {0.25, 0.25, 1}, {a, b, c}), 0.5);
  EXPECT_EQ(segment_hit({0.25, 0.25, 0}, {0.25, 0.25, 1}, {a, b, c}), 0.0);
  EXPECT_EQ(segment_hit({0.25, 0.25, 1}, {0.25, 0.25, 0}, {a, b, c}), 1.0);
  EXPECT_EQ(segment_hit({1, 0, -1}, {1, 0, 1}, {a, b, c}), 0.5);                                  // through a corner
  EXPECT_EQ(segment_hit({std::nextafter(1.0, 2.0), 0, -1}, {1, 0, 1}, {a, b, c}), std::nullopt);  // and beside it
  EXPECT_EQ(segment_hit({-1, 0.25, 0}, {1, 0.25, 0}, {a, b, c}), std::nullopt);                   // in its plane
  EXPECT_EQ(segment_hit({0.25, 0.25, 0x1p-1074}, {0.25, 0.25, 1}, {a, b, c}), std::nullopt);
  EXPECT_EQ(segment_hit({0.25, 0.25, -1}, {0.25, 0.25, 1}, {a, b, {2, 0, 0}}), std::nullopt);  // without area
}

// Whole numbers, so that many ends and edges are in planes of triangles, on their sides or at their corners.
TEST(HitFinder, FindsWhatSegmentsHitOneByOne) {
  const DefaultFloatingPoint guard;
  Random random(21);
  const auto point = [&](double size, double step) {
    const auto number = [&] { return step * std::round(uniform(random, -size, size)); };
    return Vec3{number(), number(), number()};
  };
  std::size_t at_ends = 0, between = 0;
  for (const double step : {1.0, 0.1, 0x1p-40}) {
    for (int round = 0; round < 300; ++round) {
      const TriangleMesh mesh{{point(3, step), point(3, step), point(3, step), point(3, step)},
                              {{0, 1, 2}, {1, 2, 3}, {0, 3, 1}}};
      HitFinder finder(mesh);
      for (int ends = 0; ends < 3; ++ends) {
        const Vec3 end = point(2, step);
        finder.enter(end, std::array<std::uint32_t, 3>{0, 1, 2});
        for (int others = 0; others < 7; ++others) {
          const Vec3 other = point(2, step);
          const bool from_end = others % 2 == 0;
          const Vec3 &p = from_end ? end : other, &q = from_end ? other : end;
          std::vector<SegmentHit> hits;
          finder.find(other, from_end ? HitFinder::Way::kFromEnd : HitFinder::Way::kToEnd, hits);
          for (std::uint32_t triangle = 0; triangle < 3; ++triangle) {
            const Triangle& t = mesh.triangles[triangle];
            const auto hit = std::ranges::find(hits, triangle, &SegmentHit::triangle);
            const std::optional<double> found = hit == hits.end() ? std::nullopt : std::optional(hit->at);
            const std::optional<double> here = segment_hit(p, q, corners_of(mesh, t));
            ASSERT_EQ(found, here) << step << " " << round << " " << ends << " " << others << " " << triangle;
            at_ends += here == 0.0 || here == 1.0 ? 1 : 0;
            between += here && *here > 0.0 && *here < 1.0 ? 1 : 0;
          }
        }
      }
    }
  }
  EXPECT_GT(at_ends, 1000U);
  EXPECT_GT(between, 1000U);
}

// Both ends are nearer to the triangle's plane than numbers of 64 bits can tell.
TEST(SegmentHit, IsRightWhereTheSegmentIsNearlyInThePlane) {
  Random random(31);
  int hits = 0;
  for (int n = 0; n < 2000; ++n) {
    TriangleMesh mesh{{}, {{0, 1, 2}}};
    const double size = std::exp2(uniform(random, -8, 8));
    for (int corner = 0; corner < 3; ++corner)
      mesh.vertices.push_back(
          {uniform(random, -size, size), uniform(random, -size, size), uniform(random, -size, size)});
    const Vec3 &a = mesh.vertices[0], &b = mesh.vertices[1], &c = mesh.vertices[2];
    const double u = uniform(random, 0, 0.5), v = uniform(random, 0, 0.5);
    const Vec3 p = a + u * (b - a) + v * (c - a),
               q = p + uniform(random, 0, 2) * (b - a) + uniform(random, 0, 2) * (c - a);
    const std::optional<double> at = segment_hit(p, q, {a, b, c});
    if (!at) continue;
    ++hits;
    const QuadVec3 normal = cross(quad_difference(b, a), quad_difference(c, a));
    const Quad of_p = dot(normal, quad_difference(p, a)), of_q = dot(normal, quad_difference(q, a));
    EXPECT_NEAR(*at, static_cast<double>(of_p / (of_p - of_q)), 1e-14) << n;
    HitFinder finder(mesh);
    std::vector<SegmentHit> found;
    const std::vector<std::uint32_t> all{0};
    finder.enter(p, all);
    finder.find(q, HitFinder::Way::kFromEnd, found);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].at, *at);
  }
  EXPECT_GT(hits, 300);
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
    const std::optional<double> at = segment_hit(p, q, {a, b, c});
    ASSERT_TRUE(at);
    EXPECT_NEAR(*at, expected, 1e-15);
    const TriangleMesh mesh{{a, b, c}, {{0, 1, 2}}};
    HitFinder finder(mesh);
    finder.enter(p, std::vector<std::uint32_t>{0});
    std::vector<SegmentHit> hits;
    finder.find(q, HitFinder::Way::kFromEnd, hits);
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
      return segment_hit(s * points[3], s * points[4], {s * points[0], s * points[1], s * points[2]});
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
      finder.find(other, from_end ? HitFinder::Way::kFromEnd : HitFinder::Way::kToEnd, hits);
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
    finder.find(other, HitFinder::Way::kFromEnd, hits);
    return hits.empty() ? 99 : int{hits[0].jump};
  };
  EXPECT_EQ(jump({0.25, 0.25, -1}, {0.25, 0.25, 1}), -1);  // to its front, where w is less
  EXPECT_EQ(jump({0.25, 0.25, 1}, {0.25, 0.25, -1}), 1);
  EXPECT_EQ(jump({0.5, 0.0, -1}, {0.5, 0.0, 1}), 0);
  EXPECT_EQ(jump({0.0, 0.0, -1}, {0.0, 0.0, 1}), 0);
  EXPECT_EQ(jump({0.25, 0.25, 0}, {0.25, 0.25, 1}), 0);
  EXPECT_EQ(jump({2.0, 2.0, -1}, {2.0, 2.0, 1}), 99);
}

}  // namespace
}  // namespace raycone
