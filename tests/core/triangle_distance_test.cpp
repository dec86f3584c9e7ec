#include "core/distance/triangle_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/exact/direct_distance.h"
#include "tests/property/triangle_cases.h"

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
constexpr double kOfDistances = 1e-14;

TEST_F(TriangleDistanceTest, AgreesWithTheOracle) {
  for (int n = 0; n < 20000; ++n) expect_distance(point(), point(), point(), point(), kOfDistances);
}

TEST_F(TriangleDistanceTest, AgreesWithTheOracleNearTheTriangle) {
  for (int n = 0; n < 20000; ++n) {
    const Vec3 a = point(), b = point(), c = point();
    const double u = 0.75 * number(), v = 0.75 * number();
    const Vec3 p = a + u * (b - a) + v * (c - a) + 1e-3 * point();
    expect_distance(a, b, c, p, 1e-13);  // coordinates along the edges of a triangle that may be nearly flat
  }
}

TEST_F(TriangleDistanceTest, IsRightForEveryShape) {
  test::Random random(1);
  for (int family = 0; family < test::triangle_family_count(); ++family) {
    for (int n = 0; n < 20000; ++n) {
      const test::TriangleCase c = test::make_triangle_case(family, random);
      const double squared = TriangleDistance(c.corners[0], c.corners[1], c.corners[2]).squared(c.query);
      const test::DistanceError error = error_of(c, std::sqrt(squared));
      ASSERT_TRUE(error.is_small()) << "family " << family << ", case " << n << ": off by " << error.relative
                                    << " of itself, by " << error.absolute << " u of the coordinates";
    }
  }
}

// The examples of issue 13.
TEST_F(TriangleDistanceTest, IsRightNextToNeedles) {
  const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0.75, 1e-5, 0};
  for (const double height : {1e-17, 4.8e-14, 1e-10, 1e-7}) {
    for (const double x : {0.25, 0.5, 0.7, 0.9}) expect_distance(a, b, c, {x, 2e-6, height}, 4.5e-16);
  }
  const double k = 1.0 / 512;  // a sliver of 300 x 0.006 in its scale
  const Vec3 d{13 * k, 1 * k, 7 * k}, e{300 * k, 40 * k, 20 * k}, f{150 * k, 20.503 * k, 13.5 * k};
  const Vec3 normal = cross(e - d, f - d);
  const Vec3 up = (1e-7 * k / std::sqrt(dot(normal, normal))) * normal;
  for (const double s : {0.2, 0.3, 0.4}) expect_distance(d, e, f, d + s * (e - d) + s * (f - d) + up, 4.5e-16);
}

// A control: what is a little wrong is found wrong.
TEST_F(TriangleDistanceTest, ErrorsAreFound) {
  test::TriangleCase c{0, {Vec3{0.5, 0, 0}, Vec3{0, 0.5, 0}, Vec3{0, 0, 0}}, {0.125, 0.125, 0.25}};
  EXPECT_TRUE(error_of(c, 0.25).is_small());
  EXPECT_FALSE(error_of(c, 0.25 * (1 + 2e-12)).is_small());
  c.query.z = 0;
  EXPECT_TRUE(error_of(c, 1.9 * 0x1p-53).is_small());
  EXPECT_FALSE(error_of(c, 2.1 * 0x1p-53).is_small());
}

TEST_F(TriangleDistanceTest, TakesSegmentsAndPoints) {
  for (int n = 0; n < 2000; ++n) {
    const Vec3 a = point(), b = point(), p = point();
    expect_distance(a, b, b, p, kOfDistances);
    expect_distance(b, a, b, p, kOfDistances);
    expect_distance(a, a, a, p, kOfDistances);
    expect_distance(a, b, 0.5 * (a + b), p, kOfDistances);
  }
}

TEST_F(TriangleDistanceTest, TakesTinyTriangles) {
  for (const double size : {1e-60, 1e-100, 1e-160, 1e-300}) {
    for (int n = 0; n < 200; ++n) {
      const Vec3 a = 1e-3 * point();
      expect_distance(a, a + size * point(), a + size * point(), point(), kOfDistances);
      expect_distance(size * point(), size * point(), size * point(), point(), kOfDistances);
    }
  }
}

}  // namespace
}  // namespace raycone
