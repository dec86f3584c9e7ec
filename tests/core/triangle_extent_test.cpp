// What bounds a triangle's field from afar, against distances and areas found otherwise.
#include "core/far/triangle_extent.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/boundary/solid_angles.h"
#include "core/distance/triangle_distance.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::Random;

constexpr Box kUnit{{-1, -1, -1}, {1, 1, 1}};

Vec3 random_point(Random& random, const Vec3& around, double within) {
  return around + within * test::uniform_point(random, kUnit);
}

// From fat ones to needles.
SolidTriangle random_triangle(Random& random) {
  const double thin = std::pow(10.0, test::uniform(random, -9, 0));
  const Vec3 a = random_point(random, {}, 1.0), b = random_point(random, {}, 1.0);
  return solid_faces({{a, b, random_point(random, b, thin)}, {{0, 1, 2}}}).triangles.front();
}

double distance(const SolidTriangle& t, const Vec3& p) { return std::sqrt(TriangleDistance(t.a, t.b, t.c).squared(p)); }

// To points of a grid in the box.
double least_distance(const SolidTriangle& t, const Box& box) {
  constexpr int kSteps = 8;
  const Vec3 step = (1.0 / kSteps) * (box.upper - box.lower);
  double least = distance(t, box.lower);
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      for (int k = 0; k <= kSteps; ++k) {
        const Vec3 p{box.lower.x + i * step.x, box.lower.y + j * step.y, box.lower.z + k * step.z};
        least = std::min(least, distance(t, p));
      }
    }
  }
  return least;
}

TEST(TriangleExtent, GapIsAtMostTheDistanceAndMostlyNotMuchLess) {
  constexpr double kRounds = 1e-12;  // what distances of coordinates up to 1 are off by, and more
  Random random(1);
  int close = 0, by_box = 0, total = 0;
  for (int n = 0; n < 2000; ++n) {
    const SolidTriangle t = random_triangle(random);
    const TriangleExtent extent = extent_of(t);
    const Vec3 corner = random_point(random, {}, 1.0);
    const Box box{corner, corner + (n % 2 == 0 ? 0.0 : 0.1) * test::uniform_point(random, {{0, 0, 0}, {1, 1, 1}})};
    const double least = least_distance(t, box), gap = std::sqrt(square_of_gap(t, extent, box));
    ASSERT_LE(gap, least * (1 + 1e-9) + kRounds);
    if (least < 0.05) continue;
    ++total;
    close += gap > 0.7 * least;
    by_box += std::sqrt(square_of_gap(extent.box, box)) > 0.7 * least;
  }
  EXPECT_GT(close, 0.95 * total);
  EXPECT_LT(by_box, 0.75 * total) << "the control: boxes alone do not tell";
}

TEST(TriangleExtent, AreaAndWidthAreRoundedUp) {
  const auto triangle = [](double width) {
    return solid_faces({{{0, 0, 0}, {4, 0, 0}, {1, width, 0}}, {{0, 1, 2}}}).triangles.front();
  };
  for (const double width : {2.0, 1e-3, 1e-12}) {
    const TriangleExtent extent = extent_of(triangle(width));
    EXPECT_GE(extent.area, 2 * width);
    EXPECT_LT(extent.area, 2 * width * (1 + 1e-11));
    EXPECT_GE(extent.width, width);
    EXPECT_LT(extent.width, width * (1 + 1e-11));
  }
}

TEST(TriangleExtent, OfWhatHasNoPlaneTheBoxTells) {
  const Box box{{2, 0, 0}, {3, 1, 1}};
  for (const Vec3& c : {Vec3{0, 0, 0}, Vec3{0.5, 0.5, 0}, Vec3{1e-200, 0, 1e-200}}) {
    const SolidTriangle t{{0, 0, 0}, {1, 1, 0}, c, {0, 0, 0}, 1.0};
    EXPECT_NEAR(square_of_gap(t, extent_of(t), box), 1.0, 1e-9);
  }
  SolidTriangle unknown{{0, 0, 0}, {1, 1, 0}, {0, 1, 0}, {std::nan(""), 0, 1}, 1.0};
  EXPECT_NEAR(square_of_gap(unknown, extent_of(unknown), box), 1.0, 1e-9);
  EXPECT_TRUE(std::isnan(extent_of(unknown).area));
}

}  // namespace
}  // namespace raycone
