// The oracle of distances, on what can be told without one.
#include "core/exact/direct_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/shapes.h"

namespace raycone {
namespace {

double distance(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& q) {
  return static_cast<double>(direct_distance({{a, b, c}, {{0, 1, 2}}}, q));
}

TEST(DirectDistance, KnowsEveryRegionOfATriangle) {
  const Vec3 a{0, 0, 0}, b{4, 0, 0}, c{0, 4, 0};
  EXPECT_EQ(distance(a, b, c, {1, 1, 3}), 3) << "above the inside";
  EXPECT_EQ(distance(a, b, c, {1, 1, -3}), 3) << "below it";
  EXPECT_EQ(distance(a, b, c, {2, -3, 4}), 5) << "beside an edge";
  EXPECT_EQ(distance(a, b, c, {3, 3, 1}), std::sqrt(3.0)) << "beside the longest edge";
  EXPECT_EQ(distance(a, b, c, {-3, -4, 0}), 5) << "before a corner";
  EXPECT_EQ(distance(a, b, c, {6, -2, 1}), 3) << "before a sharp corner";
  EXPECT_EQ(distance(a, b, c, {1, 2, 0}), 0) << "on it";
  EXPECT_EQ(distance(a, b, c, {2, 2, 0}), 0) << "on an edge";
  EXPECT_EQ(distance(a, b, c, {4, 0, 0}), 0) << "on a corner";
}

TEST(DirectDistance, KnowsSegmentsAndPoints) {
  const Vec3 a{0, 0, 0}, b{0, 0, 1}, middle{0, 0, 0.25};
  EXPECT_EQ(distance(a, b, b, {3, 4, 0.5}), 5);
  EXPECT_EQ(distance(a, b, middle, {3, 4, 0.5}), 5);
  EXPECT_EQ(distance(middle, a, b, {0, 3, -4}), 5);
  EXPECT_EQ(distance(b, b, b, {3, 0, 5}), 5);
}

// Where a needle's normal takes all digits that there are.
TEST(DirectDistance, KnowsNeedlesOfAnyWidth) {
  for (const double width : {1e-5, 1e-20, 1e-200, 1e-300}) {
    const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{1, width, 0};
    EXPECT_EQ(distance(a, b, c, {0.75, width / 2, 0}), 0) << width;
    EXPECT_EQ(distance(a, b, c, {0.75, -width, 0}), width);
    EXPECT_EQ(distance(a, b, c, {2, width, 0}), 1);
    const double beside = 0.25 / std::hypot(1, width);  // in the plane, from an edge of slope `width`
    EXPECT_DOUBLE_EQ(distance(a, b, c, {0.5, 0.75 * width, width / 4}) / width, std::hypot(beside, 0.25));
  }
}

TEST(DirectDistance, HoldsForAllMagnitudes) {
  const double largest = std::numeric_limits<double>::max(), least = std::numeric_limits<double>::denorm_min();
  const Vec3 a{0, 0, 0};
  EXPECT_EQ(distance(a, {largest, 0, 0}, {0, largest, 0}, {largest / 4, largest / 4, least}), least);
  EXPECT_EQ(distance(a, {least, 0, 0}, {0, least, 0}, {0, 0, largest}), largest);
  EXPECT_EQ(distance(a, {largest, 0, 0}, {largest, least, 0}, {largest / 2, -3 * least, 4 * least}), 5 * least);
  EXPECT_EQ(direct_distance({{{-largest, 0, 0}}, {{0, 0, 0}}}, {largest, 0, 0}), 2 * Quad{largest});
  EXPECT_EQ(static_cast<double>(direct_distance({{a}, {}}, {0, 0, 0})), HUGE_VAL) << "no triangle";
}

// The boxes that are passed over hold no nearer triangle: the least of all triangles by themselves is the mesh's.
TEST(DirectDistance, IsTheLeastOfAllTriangles) {
  const TriangleMesh mesh = test::assorted_triangles();
  test::Random random(1);
  for (int n = 0; n < 50; ++n) {
    const Vec3 q = test::uniform_point(random, {{-1, -1, -1}, {2, 2, 2}});
    Quad least = HUGE_VAL;
    for (const Triangle& t : mesh.triangles) least = std::min(least, direct_distance({mesh.vertices, {t}}, q));
    EXPECT_EQ(direct_distance(mesh, q), least);
  }
}

}  // namespace
}  // namespace raycone
