// Where segments pass through triangles.
#include "core/surface/edge_crossing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

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
  EXPECT_EQ(segment_hit({0.25, 0.25, -1}, {0.25, 0.25, 1}, a, b, c), 0.5);
  EXPECT_EQ(segment_hit({0.25, 0.25, 0}, {0.25, 0.25, 1}, a, b, c), 0.0);
  EXPECT_EQ(segment_hit({0.25, 0.25, 1}, {0.25, 0.25, 0}, a, b, c), 1.0);
  EXPECT_EQ(segment_hit({1, 0, -1}, {1, 0, 1}, a, b, c), 0.5);                                  // through a corner
  EXPECT_EQ(segment_hit({std::nextafter(1.0, 2.0), 0, -1}, {1, 0, 1}, a, b, c), std::nullopt);  // and beside it
  EXPECT_EQ(segment_hit({-1, 0.25, 0}, {1, 0.25, 0}, a, b, c), std::nullopt);                   // in its plane
  EXPECT_EQ(segment_hit({0.25, 0.25, 0x1p-1074}, {0.25, 0.25, 1}, a, b, c), std::nullopt);
  EXPECT_EQ(segment_hit({0.25, 0.25, -1}, {0.25, 0.25, 1}, a, b, {2, 0, 0}), std::nullopt);  // without area
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
          finder.find(other, from_end, hits);
          for (std::uint32_t triangle = 0; triangle < 3; ++triangle) {
            const Triangle& t = mesh.triangles[triangle];
            const auto hit = std::ranges::find(hits, triangle, &SegmentHit::triangle);
            const std::optional<double> found = hit == hits.end() ? std::nullopt : std::optional(hit->at);
            const std::optional<double> here =
                segment_hit(p, q, mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
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
    const std::optional<double> at = segment_hit(p, q, a, b, c);
    if (!at) continue;
    ++hits;
    const QuadVec3 normal = cross(quad_difference(b, a), quad_difference(c, a));
    const Quad of_p = dot(normal, quad_difference(p, a)), of_q = dot(normal, quad_difference(q, a));
    EXPECT_NEAR(*at, static_cast<double>(of_p / (of_p - of_q)), 1e-14) << n;
    HitFinder finder(mesh);
    std::vector<SegmentHit> found;
    const std::vector<std::uint32_t> all{0};
    finder.enter(p, all);
    finder.find(q, true, found);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].at, *at);
  }
  EXPECT_GT(hits, 300);
}

}  // namespace
}  // namespace raycone
