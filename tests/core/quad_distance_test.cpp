// The distances of tests and those of --verify are two programs for one definition.
#include "tests/support/quad_distance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/exact/direct_distance.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

TEST(QuadDistance, IsThatOfTheDefinition) {
  test::Random random(1);
  const Box box{{-1, -1, -1}, {1, 1, 1}};
  for (int i = 0; i < 600; ++i) {
    const Vec3 a = test::uniform_point(random, box), b = test::uniform_point(random, box);
    const double height = i % 3 == 0 ? 1.0 : std::pow(10.0, -test::uniform(random, 0, 14));
    const Vec3 c = a + test::uniform(random, -0.5, 1.5) * (b - a) + height * test::uniform_point(random, box);
    const TriangleMesh mesh{{a, b, c}, {{0, 1, 2}, {0, 1, 1}}};
    const Vec3 p = i % 2 == 0 ? test::uniform_point(random, box)
                              : a + 0.3 * (b - a) + 0.2 * (c - a) + 1e-3 * height * test::uniform_point(random, box);
    // In doubles: what is left of 113 bits where 47 cancel in the sides of the thinnest triangles.
    EXPECT_NEAR(static_cast<double>(test::quad_distance(mesh, p)), static_cast<double>(direct_distance(mesh, p)),
                1e-17);
  }
}

TEST(QuadDistance, OfSimplePlacesIsExact) {
  const TriangleMesh mesh{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{0, 1, 2}}};
  EXPECT_EQ(static_cast<double>(test::quad_distance(mesh, {1, 1, 3})), 3.0);
  EXPECT_EQ(static_cast<double>(test::quad_distance(mesh, {2, -3, 0})), 3.0);
  EXPECT_EQ(static_cast<double>(test::quad_distance(mesh, {-3, -4, 0})), 5.0);
  EXPECT_EQ(static_cast<double>(test::quad_distance(mesh, {1, 2, 0})), 0.0);
}

}  // namespace
}  // namespace raycone
