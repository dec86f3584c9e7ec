#include "core/exact/direct_sum.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/direct_winding_number.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

// Seen from a point on it, a triangle fills half the sphere; which half, 113 bits cannot tell from too close.
TEST(DirectSum, KnowsTheSideOfATriangleFromHoweverClose) {
  // x + 2 y + 3 z = 0, about the origin; (1, 2, 3) is in front
  const TriangleMesh mesh{{{2, -1, 0}, {1, 1, -1}, {-3, 0, 1}}, {{0, 1, 2}}};
  for (const double distance : {1e-10, 1e-20, 1e-32, 1e-34, 1e-40, 1e-100, 1e-300, 5e-324}) {
    for (const double side : {-1.0, 1.0}) {
      const auto [value, error] = perturbed_direct_sum(mesh, {side * distance, 0, 0});
      // Up to the distance, and to half a turn in double.
      EXPECT_LE(std::abs(static_cast<double>(value) + side * 0.5), static_cast<double>(error) + 10 * distance + 1e-15)
          << side * distance;
      EXPECT_LT(error, 1e-20);
    }
  }
  EXPECT_NEAR(static_cast<double>(perturbed_direct_sum(mesh, {0, 0, 0}).value), -0.5, 1e-15) << "moved along x";
}

// The direct sum of --verify and the oracle of the tests are two programs for one definition.
TEST(DirectSum, IsTheOraclesWithinBothErrors) {
  test::Random random(2);
  int close = 0;
  for (const TriangleMesh& mesh : {test::soup(random, 30), test::fan(9, 6), test::assorted_triangles()}) {
    for (int i = 0; i < 200; ++i) {
      Vec3 q = test::uniform_point(random, {{-0.2, -0.2, -0.2}, {1.2, 1.2, 1.2}});
      const Vec3& v = mesh.vertices[random() % mesh.vertices.size()];
      if (i % 2 == 0) q = v + std::pow(10.0, -test::uniform(random, 1, 16)) * (q - v);
      const QuadWithin sum = perturbed_direct_sum(mesh, q);
      const test::WithinQuad oracle = test::winding_number_within(mesh, q);
      const Quad difference = sum.value > oracle.value ? sum.value - oracle.value : oracle.value - sum.value;
      EXPECT_LE(static_cast<double>(difference), static_cast<double>(sum.error + oracle.error)) << i;
      close += static_cast<double>(sum.error + oracle.error) < 1e-20;
    }
  }
  EXPECT_GT(close, 500);
}

}  // namespace
}  // namespace raycone
