#include "core/direct_sum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace raycone {
namespace {

// Seen from a point on it, a triangle fills half the sphere; which half, 113 bits cannot tell from too close.
TEST(DirectSum, KnowsWhenItCannotTellTheSideOfATriangle) {
  const Vec3 a{2, -1, 0}, b{1, 1, -1}, c{-3, 0, 1};  // x + 2 y + 3 z = 0, about the origin; (1, 2, 3) is in front
  int decided = 0;
  for (const double distance : {1e-10, 1e-20, 1e-32, 1e-34, 1e-40, 1e-100, 1e-300, 5e-324}) {
    for (const double side : {-1.0, 1.0}) {
      const auto [value, error] = half_solid_angle(a, b, c, {side * distance, 0, 0});
      // Up to the distance, and to pi in double.
      EXPECT_LE(std::abs(static_cast<double>(value) + side * std::numbers::pi),
                static_cast<double>(error) + 10 * distance + 1e-15)
          << side * distance;
      decided += error < 1;
    }
  }
  EXPECT_GE(decided, 4);  // at 1e-20 it can
}

}  // namespace
}  // namespace raycone
