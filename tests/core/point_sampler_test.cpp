#include "core/sampling/point_sampler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/exact/direct_distance.h"
#include "core/exact/exact_determinant.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

std::vector<Vec3> all(const PointSampler& sampler) {
  std::vector<Vec3> points(sampler.size());
  sampler.draw(0, points);
  return points;
}

const Box kBox{{-1, 0, 2}, {3, 0.5, 7}};

TEST(PointSampler, UniformPointsFillTheBox) {
  const auto points = all(PointSampler(test::box_mesh({0, 0, 0}, {1, 1, 1}), kBox, {UniformSamples{20000}}, 1));
  ASSERT_EQ(points.size(), 20000U);
  for (int axis = 0; axis < 3; ++axis) {
    double sum = 0.0, least = 1e9, most = -1e9;
    for (const Vec3& p : points) {
      sum += p[axis];
      least = std::min(least, p[axis]);
      most = std::max(most, p[axis]);
    }
    const double side = kBox.upper[axis] - kBox.lower[axis];
    EXPECT_GE(least, kBox.lower[axis]);
    EXPECT_LE(most, kBox.upper[axis]);
    EXPECT_GT(most - least, 0.998 * side);
    // Five standard deviations of a mean, 0.29 sides / sqrt(n).
    EXPECT_NEAR(sum / 20000, kBox.lower[axis] + side / 2, 0.0103 * side);
  }
}

TEST(PointSampler, SurfacePointsAreSpreadByArea) {
  const TriangleMesh mesh = test::box_mesh({0, 0, 0}, {1, 1, 0.25});  // top and bottom: 2 of 3 units of area
  const auto points = all(PointSampler(mesh, kBox, {NearSamples{20000, 0.0}}, 1));
  int caps = 0, left_half = 0;
  for (const Vec3& p : points) {
    EXPECT_LT(direct_distance(mesh, p), 1e-15);
    caps += p.z == 0 || p.z == 0.25;
    left_half += p.x < 0.5;
  }
  // Five standard deviations, sqrt(p (1 - p) n).
  EXPECT_NEAR(caps, 20000 * 2.0 / 3, 334);
  EXPECT_NEAR(left_half, 10000, 354);
}

TEST(PointSampler, NoiseIsInDiagonalsOfTheMesh) {
  const TriangleMesh mesh = test::box_mesh({0, 0, 0}, {3, 4, 12});  // diagonal 13
  const auto still = all(PointSampler(mesh, kBox, {NearSamples{20000, 0.0}}, 1));
  const auto moved = all(PointSampler(mesh, kBox, {NearSamples{20000, 0.02}}, 1));
  double squares = 0.0;
  for (std::size_t n = 0; n < still.size(); ++n) squares += dot(moved[n] - still[n], moved[n] - still[n]);
  EXPECT_NEAR(std::sqrt(squares / (3 * 20000)), 0.26, 0.26 * 5 / std::sqrt(2 * 60000.0)) << "five standard deviations";
}

TEST(PointSampler, PointsDependOnTheirNumberAloneAndOnTheSeed) {
  const TriangleMesh mesh = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const std::vector<SampleGroup> groups{UniformSamples{5000}, NearSamples{7000, 0.1}, UniformSamples{3}};
  const PointSampler sampler(mesh, kBox, groups, 1);
  EXPECT_EQ(sampler.size(), 12003U);
  const auto points = all(sampler);
  for (const std::size_t first : {0U, 4999U, 12000U}) {
    std::vector<Vec3> some(3);
    sampler.draw(first, some);
    for (std::size_t n = 0; n < 3; ++n) EXPECT_EQ(some[n], points[first + n]);
  }
  EXPECT_NE(all(PointSampler(mesh, kBox, groups, 2)).front(), points.front());
}

// Against the same triangle in a size at which nothing over- or underflows. A power of two leaves a normal as it is.
TEST(PointSampler, NormalsAreThoseOfTheFacesAtAnySize) {
  test::Random random(7);
  const Box cube{{-1, -1, -1}, {1, 1, 1}};
  for (int i = 0; i < 300; ++i) {
    const Vec3 a = test::uniform_point(random, cube), b = test::uniform_point(random, cube);
    const double thin = std::exp2(test::uniform(random, -40, 0));
    const Vec3 c = 0.5 * (a + b) + thin * test::uniform_point(random, cube);
    const QuadVec3 n = cross_of_differences(b, c, a);
    const auto length = std::sqrt(static_cast<long double>(dot(n, n)));
    for (const int exponent : {0, 400, 1000, -400, -900}) {
      TriangleMesh mesh{{a, b, c}, {{0, 1, 2}}};
      for (Vec3& v : mesh.vertices) v = std::exp2(exponent) * v;
      const std::array<std::int64_t, 2> faces{0, -1};
      std::array<Vec3, 2> normals;
      PointSampler(mesh, bounding_box(mesh), {SurfaceSamples{2}}, 1).set_normals(faces, normals);
      // Each part is rounded twice, and the length once: four roundings of 2^-53 at most.
      EXPECT_NEAR(normals[0].x, static_cast<double>(static_cast<long double>(n.x) / length), 0x1p-51);
      EXPECT_NEAR(normals[0].y, static_cast<double>(static_cast<long double>(n.y) / length), 0x1p-51);
      EXPECT_NEAR(normals[0].z, static_cast<double>(static_cast<long double>(n.z) / length), 0x1p-51);
      EXPECT_EQ(normals[1], Vec3{});
    }
  }
}

TEST(PointSampler, TakesMeshesOfAnySize) {
  for (const double size : {1e-300, 1e300}) {
    const TriangleMesh mesh = test::box_mesh({0, 0, 0}, {size, size, size});
    const PointSampler sampler(mesh, bounding_box(mesh), {NearSamples{100, 0.01}}, 1);
    EXPECT_TRUE(sampler.has_needed_area());
    for (const Vec3& p : all(sampler)) EXPECT_LT(std::abs(p.x - size / 2), 0.6 * size);
  }
  EXPECT_FALSE(PointSampler({{{1, 2, 3}}, {{0, 0, 0}}}, kBox, {SurfaceSamples{1}}, 1).has_needed_area());
}

}  // namespace
}  // namespace raycone
