#include "core/triangle_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/direct_distance.h"

namespace raycone {
namespace {

class TriangleDistanceTest : public testing::Test {
 protected:
  double number() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  Vec3 point() { return {number(), number(), number()}; }

  // The distance agrees with the oracle within `tolerance`.
  static void expect_distance(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p, double tolerance) {
    const TriangleMesh mesh{{a, b, c}, {{0, 1, 2}}};
    EXPECT_NEAR(std::sqrt(TriangleDistance(a, b, c).squared(p)), static_cast<double>(direct_distance(mesh, p)),
                tolerance);
  }

  std::mt19937 random_{1};
};

TEST_F(TriangleDistanceTest, IsThatOfTheClosestPointInEachRegion) {
  const Vec3 a{0, 0, 0}, b{4, 0, 0}, c{0, 4, 0};
  const TriangleDistance triangle(a, b, c);
  EXPECT_EQ(triangle.squared({1, 1, 3}), 9.0) << "above the inside";
  EXPECT_EQ(triangle.squared({1, 1, -3}), 9.0) << "below it";
  EXPECT_EQ(triangle.squared({2, -3, 0}), 9.0) << "beside an edge";
  EXPECT_EQ(triangle.squared({3, 3, 1}), 2.0 + 1.0) << "beside the longest edge";
  EXPECT_EQ(triangle.squared({-3, -4, 0}), 25.0) << "before a corner";
  EXPECT_EQ(triangle.squared({6, -2, 0}), 8.0) << "before a sharp corner";
  EXPECT_EQ(triangle.squared({1, 2, 0}), 0.0) << "on it";
}

// Products of numbers below 2 in magnitude, each rounded by 1.1e-16: some dozens of them.
constexpr double kRounding = 1e-14;

TEST_F(TriangleDistanceTest, AgreesWithTheOracle) {
  for (int n = 0; n < 20000; ++n) expect_distance(point(), point(), point(), point(), kRounding);
}

TEST_F(TriangleDistanceTest, AgreesWithTheOracleNearTheTriangle) {
  for (int n = 0; n < 20000; ++n) {
    const Vec3 a = point(), b = point(), c = point();
    const double u = 0.75 * number(), v = 0.75 * number();
    const Vec3 p = a + u * (b - a) + v * (c - a) + 1e-3 * point();
    expect_distance(a, b, c, p, 1e-13);  // coordinates along the edges of a triangle that may be nearly flat
  }
}

TEST_F(TriangleDistanceTest, TakesNeedles) {
  for (int n = 0; n < 20000; ++n) {
    const Vec3 a = point(), b = point();
    const double width = std::pow(10.0, -16 * std::abs(number()));
    const Vec3 c = a + std::abs(number()) * (b - a) + width * point();
    // Where the angle is s, an error of 1e-16 / s of the place, at most s: never above 1e-8.
    expect_distance(a, b, c, a + std::abs(number()) * (b - a) + 0.01 * point(), 3e-8);
  }
}

TEST_F(TriangleDistanceTest, TakesSegmentsAndPoints) {
  for (int n = 0; n < 2000; ++n) {
    const Vec3 a = point(), b = point(), p = point();
    expect_distance(a, b, b, p, kRounding);
    expect_distance(b, a, b, p, kRounding);
    expect_distance(a, a, a, p, kRounding);
    expect_distance(a, b, 0.5 * (a + b), p, kRounding);
  }
}

TEST_F(TriangleDistanceTest, TakesTinyTriangles) {
  for (const double size : {1e-60, 1e-100, 1e-160, 1e-300}) {
    for (int n = 0; n < 200; ++n) {
      const Vec3 a = 1e-3 * point();
      expect_distance(a, a + size * point(), a + size * point(), point(), kRounding);
    }
  }
}

}  // namespace
}  // namespace raycone
