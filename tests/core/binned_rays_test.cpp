#include "core/crossings/binned_rays.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "tests/support/shapes.h"

namespace raycone {
namespace {

std::vector<NumberedRay> numbered(const std::vector<Vec3>& origins) {
  std::vector<NumberedRay> rays;
  for (std::uint32_t i = 0; i < origins.size(); ++i) rays.push_back({origins[i], 7 * i});
  return rays;
}

// By definition.
std::vector<std::uint32_t> rays_that_meet(const Box& box, const std::vector<NumberedRay>& rays) {
  std::vector<std::uint32_t> met;
  for (const auto& [q, number] : rays) {
    const bool across = box.lower.y <= q.y && q.y <= box.upper.y && box.lower.z <= q.z && q.z <= box.upper.z;
    if (across && q.x <= box.upper.x) met.push_back(number);
  }
  return met;
}

struct Looks {
  std::size_t met = 0, looked = 0;
};

// Boxes whose ends are coordinates of rays, or next to these, or anywhere.
Looks check(const std::vector<NumberedRay>& rays, test::Random& random) {
  const BinnedRays binned(rays);
  Looks looks;
  for (int n = 0; n < 300; ++n) {
    Vec3 ends[2];
    for (Vec3& end : ends) {
      for (int axis = 0; axis < 3; ++axis) {
        const double at = rays[static_cast<std::size_t>(test::uniform(random, 0, double(rays.size())))].origin[axis];
        const double next = std::nextafter(at, random() % 2 == 0 ? -2.0 : 2.0);
        end[axis] = n % 3 == 0 ? at : n % 3 == 1 ? next : test::uniform(random, -1, 2);
      }
    }
    const Box box = box_of(ends[0], ends[1]);
    std::vector<std::uint32_t> met;
    looks.looked += binned.for_each_met(box, [&](const NumberedRay& ray) {
      EXPECT_EQ(ray.origin, rays[ray.number / 7].origin);
      met.push_back(ray.number);
    });
    std::ranges::sort(met);
    EXPECT_EQ(met, rays_that_meet(box, rays));
    looks.met += met.size();
  }
  return looks;
}

TEST(BinnedRays, AreMetByBoxesAsTheDefinitionSays) {
  test::Random random(1);
  for (const std::size_t count : {1U, 2U, 3U, 64U, 1000U, 5000U}) {
    std::vector<Vec3> origins(count);
    for (Vec3& q : origins) q = test::uniform_point(random, {{0, 0, 0}, {1, 1, 1}});
    EXPECT_GT(check(numbered(origins), random).met, 20U) << count;
  }
}

// Some share a coordinate, some are as far apart as numbers go.
TEST(BinnedRays, MayLieAnyhow) {
  constexpr double l = std::numeric_limits<double>::max(), least = std::numeric_limits<double>::denorm_min();
  test::Random random(2);
  for (const double far : {0.0, least, 1e-320, 1e-310, 1e-17, 1.0, 1e17, 1e300, l}) {
    std::vector<Vec3> origins{{-far, far, -far}, {far, -far, far}, {-l, 0.5, 0.5}, {far, 0.5, 0.5}};
    for (int i = 0; i < 60; ++i) {
      const Vec3 q = test::uniform_point(random, {{-1, 0, 0}, {4, 4, 4}});
      origins.push_back({q.x, i % 2 == 0 ? q.y : far, i % 3 == 0 ? 0.5 : q.z});
    }
    EXPECT_GT(check(numbered(origins), random).met, 100U) << far;
    EXPECT_GT(check(numbered(std::vector<Vec3>(50, origins.front())), random).met, 100U) << far;
  }
}

TEST(BinnedRays, MayBeNone) {
  const BinnedRays none({});
  EXPECT_EQ(none.for_each_met({{-1, -1, -1}, {1, 1, 1}}, [](const NumberedRay&) { FAIL(); }), 1U);
}

// A box that is small among many rays is compared with few of them.
TEST(BinnedRays, AreLookedAtOnlyNearBoxes) {
  test::Random random(3);
  std::vector<Vec3> origins(10'000);
  for (Vec3& q : origins) q = test::uniform_point(random, {{0, 0, 0}, {1, 1, 1}});
  const BinnedRays binned(numbered(origins));
  std::size_t looked = 0;
  for (int n = 0; n < 1000; ++n) {
    const Vec3 q = test::uniform_point(random, {{0, 0, 0}, {1, 0.99, 0.99}});
    looked += binned.for_each_met({q, {1, q.y + 0.01, q.z + 0.01}}, [](const NumberedRay&) {});
  }
  EXPECT_LT(looked, 6000U);  // one ray, two or three rows, and rays of bins that are met in part
}

}  // namespace
}  // namespace raycone
