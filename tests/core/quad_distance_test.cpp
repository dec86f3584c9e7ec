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
    // A few roundings to 113 bits, times the triangle's length over its height: by that its plane may be turned. Of
    // 12000 such cases, in decimal numbers of 34 digits, the worst misses by 6e-33 / height.
    const Quad difference = test::quad_distance(mesh, p) - direct_distance(mesh, p);
    EXPECT_LT(static_cast<double>(difference < 0 ? -difference : difference), 1e-31 / height) << i;
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
