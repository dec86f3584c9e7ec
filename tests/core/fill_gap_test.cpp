// Gaps between planes of a mesh: filled by these planes, where the mesh goes on in them.
#include "core/sharpening/fill_gap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/distance/distance.h"
#include "core/machine/floating_point.h"
#include "tests/support/shapes.h"
#include "tests/support/values.h"

namespace raycone {
namespace {

// A unit box, and loops on it whose sides name what is behind them by the direction of its front; corners are in its
// plane.
class Gap {
 public:
  explicit Gap(TriangleMesh mesh = test::box_mesh({0, 0, 0}, {1, 1, 1})) : mesh_(std::move(mesh)), distances_(mesh_) {}

  void add(const Vec3& corner, const Vec3& front) {
    loop_.corners.push_back(corner);
    loop_.fronts.push_back(0.01 * front);
    for (std::size_t face = 0; face < mesh_.triangles.size(); ++face) {
      const Triangle& t = mesh_.triangles[face];
      const Vec3& a = mesh_.vertices[t[0]];
      const Vec3 normal = cross(mesh_.vertices[t[1]] - a, mesh_.vertices[t[2]] - a);
      if (dot(normal, front) < 0.9 * norm(normal) || std::abs(dot(normal, corner - a)) > 1e-9) continue;
      loop_.sources.push_back(static_cast<std::int32_t>(face));
      return;
    }
  }

  // `anywhere`: also off the mesh.
  [[nodiscard]] std::optional<GapFill> filled(std::size_t new_corners, const std::optional<Vec3>& corner = {},
                                              bool anywhere = false) const {
    const DefaultFloatingPoint guard;
    const GapLimits limits{1e-9, 1.0, new_corners, CoordinatePrecision::kDouble, [&](std::span<const Vec3> points) {
                             const std::vector<double> distances = test::values_of(distances_, points);
                             return anywhere || std::ranges::all_of(distances, [](double d) { return d <= 1e-9; });
                           }};
    return corner ? fill_gap_from(*corner, loop_, mesh_, limits) : fill_gap(loop_, mesh_, limits);
  }

  // The area of the triangles that have a front, which those of other fronts are taken from.
  [[nodiscard]] double area(const GapFill& fill, const Vec3& front) const {
    std::vector<Vec3> corners = loop_.corners;
    corners.insert(corners.end(), fill.corners.begin(), fill.corners.end());
    double sum = 0.0;
    for (const auto& [a, b, c] : fill.triangles) {
      const Vec3 normal = 0.5 * cross(corners[b] - corners[a], corners[c] - corners[a]);
      if (std::abs(dot(normal, front)) > 0.9 * norm(normal)) sum += dot(normal, front);
    }
    return sum;
  }

  GapLoop loop_;

 private:
  TriangleMesh mesh_;
  DistanceEvaluator distances_;
};

constexpr Vec3 kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1};

TEST(FillGap, CutsOnePlaneIntoTrianglesOfTheSameFront) {
  Gap gap;
  for (const Vec3& corner : {Vec3{0.1, 0.1, 1}, {0.5, 0.3, 1}, {0.9, 0.1, 1}, {0.5, 0.9, 1}}) gap.add(corner, kZ);
  const std::optional<GapFill> fill = gap.filled(0);
  ASSERT_TRUE(fill);
  EXPECT_EQ(fill->triangles.size(), 2U);
  EXPECT_NEAR(gap.area(*fill, kZ), 0.24, 1e-12);
}

// Two corners are on the edge between the planes: the edge leads from one to the other.
TEST(FillGap, PutsTheEdgeWhereTwoPlanesMeet) {
  Gap gap;
  gap.add({1, 0.2, 1}, kX);
  gap.add({1, 0.2, 0.9}, kX);
  gap.add({1, 0.8, 0.9}, kX);
  gap.add({1, 0.8, 1}, kZ);
  gap.add({0.9, 0.8, 1}, kZ);
  gap.add({0.9, 0.2, 1}, kZ);
  const std::optional<GapFill> fill = gap.filled(0);
  ASSERT_TRUE(fill);
  EXPECT_EQ(fill->triangles.size(), 4U);
  EXPECT_NEAR(gap.area(*fill, kX), 0.06, 1e-12);
  EXPECT_NEAR(gap.area(*fill, kZ), 0.06, 1e-12);
}

TEST(FillGap, PutsACornerWhereThreePlanesMeet) {
  Gap gap;
  gap.add({1, 0.9, 1}, kX);
  gap.add({1, 1, 0.8}, kY);
  gap.add({0.7, 1, 1}, kZ);
  EXPECT_FALSE(gap.filled(0));
  const std::optional<GapFill> fill = gap.filled(1);
  ASSERT_TRUE(fill);
  ASSERT_EQ(fill->corners.size(), 1U);
  EXPECT_LT(norm(fill->corners[0] - Vec3{1, 1, 1}), 1e-15);
  EXPECT_NEAR(gap.area(*fill, kX), 0.5 * 0.1 * 0.2, 1e-15);
  EXPECT_NEAR(gap.area(*fill, kY), 0.5 * 0.2 * 0.3, 1e-15);
  EXPECT_NEAR(gap.area(*fill, kZ), 0.5 * 0.3 * 0.1, 1e-15);
}

// Two corners of the box are within the gap, and so is the edge between them.
TEST(FillGap, PutsTwoCorners) {
  Gap gap;
  gap.add({1, 0, 0.9}, kX);
  gap.add({1, 1, 0.9}, kY);
  gap.add({0.9, 1, 1}, kZ);
  gap.add({0.9, 0, 1}, {0, -1, 0});
  EXPECT_FALSE(gap.filled(1));
  const std::optional<GapFill> fill = gap.filled(2);
  ASSERT_TRUE(fill);
  EXPECT_EQ(fill->corners.size(), 2U);
  EXPECT_NEAR(gap.area(*fill, kX), 0.1, 1e-12);
  EXPECT_NEAR(gap.area(*fill, kZ), 0.1, 1e-12);
  EXPECT_NEAR(gap.area(*fill, kY), 0.0, 1e-12);  // 0.005 of each front
}

// Some corners of one run are on the edge already. If the shortest run were cut off first, the edge would be run along
// to and fro.
TEST(FillGap, StartsWithTheRunThatGoesOn) {
  Gap gap;
  gap.add({0.9, 1, 0}, kY);
  gap.add({1, 1, 0.14}, kX);
  gap.add({1, 1, 0.12}, kX);
  gap.add({1, 1, 0.06}, kX);
  gap.add({1, 0.9, 0}, {0, 0, -1});
  const std::optional<GapFill> fill = gap.filled(1);
  ASSERT_TRUE(fill);
  EXPECT_NEAR(gap.area(*fill, kX), 0.5 * 0.1 * 0.06, 1e-12);
  EXPECT_NEAR(gap.area(*fill, kY), 0.5 * 0.1 * 0.14, 1e-12);
}

// A step: three planes meet in (1, 1, 1), where the edge along z is concave. The loop leaves three quarters of the top.
// `on_line`: with another corner on the line where the top ends.
Gap gap_of_step(bool on_line = false) {
  Gap gap(test::cells_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  gap.add({1.5, 1, 1}, kY);
  gap.add({1, 1, 0.5}, kX);
  if (on_line) gap.add({1, 1.3, 1}, kX);
  gap.add({1, 1.5, 1}, kZ);
  gap.add({0.6, 1.4, 1}, kZ);
  gap.add({0.6, 0.6, 1}, kZ);
  gap.add({1.4, 0.6, 1}, kZ);
  return gap;
}

TEST(FillGap, FillsSectorsAroundAConcaveCorner) {
  const Gap gap = gap_of_step();
  const std::optional<GapFill> fill = gap.filled(1, Vec3{1, 1, 1});
  ASSERT_TRUE(fill);
  ASSERT_EQ(fill->corners.size(), 1U);
  EXPECT_NEAR(gap.area(*fill, kX), 0.5 * 0.5 * 0.5, 1e-12);
  EXPECT_NEAR(gap.area(*fill, kY), 0.5 * 0.5 * 0.5, 1e-12);
  // Two triangles at the notch, and a square of 0.4.
  EXPECT_NEAR(gap.area(*fill, kZ), 2 * 0.5 * (0.5 + 0.4) * 0.4 + 0.4 * 0.4, 1e-12);
}

// Corners of the loop on a line from the corner are on the sides of both sectors.
TEST(FillGap, EndsSectorsWhereALineIsNearest) {
  const Gap gap = gap_of_step(true);
  const std::optional<GapFill> fill = gap.filled(1, Vec3{1, 1, 1});
  ASSERT_TRUE(fill);
  EXPECT_NEAR(gap.area(*fill, kX), 0.5 * 0.5 * 0.3, 1e-12);
  EXPECT_NEAR(gap.area(*fill, kZ), 0.52, 1e-12);
}

TEST(FillGap, LeavesWhatDoesNotGoAroundTheCorner) {
  const Gap gap = gap_of_step();
  EXPECT_FALSE(gap.filled(1, Vec3{1, 1, 0.5}, true));  // is not in the top
  EXPECT_FALSE(gap.filled(1, Vec3{1, 1.5, 1}, true));  // is on the loop
}

TEST(FillGap, LeavesSectorsOffTheMesh) {
  Gap gap(test::cells_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  gap.add({2.5, 1, 1}, kY);  // half a cell beyond the end of the edge
  gap.add({1, 1, 0.5}, kX);
  gap.add({1, 1.5, 1}, kZ);
  gap.add({0.6, 0.6, 1}, kZ);
  EXPECT_TRUE(gap.filled(1, Vec3{1, 1, 1}, true));
  EXPECT_FALSE(gap.filled(1, Vec3{1, 1, 1}));
}

// At the middle of a chain of four cubes the plane y = 1 has faces that look up, and others that look down.
TEST(FillGap, TellsTheFrontsOfOnePlaneApart) {
  Gap gap(test::cells_mesh({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}}));
  gap.add({0.5, 1, 1}, kZ);
  gap.add({0.5, 0.5, 1}, kZ);
  gap.add({1.5, 0.5, 1}, kZ);
  gap.add({1.5, 1, 1}, {0, -1, 0});
  gap.add({1.5, 1, 1.5}, {0, -1, 0});
  gap.add({1, 1, 1.5}, {-1, 0, 0});
  gap.add({1, 1.5, 1.5}, {-1, 0, 0});
  gap.add({1, 1.5, 0.5}, {-1, 0, 0});
  gap.add({1, 1, 0.5}, kY);
  gap.add({0.5, 1, 0.5}, kY);
  const std::optional<GapFill> fill = gap.filled(1, Vec3{1, 1, 1});
  ASSERT_TRUE(fill);
  EXPECT_NEAR(gap.area(*fill, kY), 0.25 - 0.25, 1e-12);  // of both fronts
  EXPECT_NEAR(gap.area(*fill, kZ), 0.5, 1e-12);
  EXPECT_NEAR(gap.area(*fill, {-1, 0, 0}), 0.5, 1e-12);
}

// The planes of a step meet where there is no mesh; so do those of a hole in the top.
TEST(FillGap, LeavesWhatIsNotOnTheMesh) {
  TriangleMesh two = test::joined(test::box_mesh({0, 0, 0}, {1, 1, 1}), test::box_mesh({2, 0, 0}, {3, 1, 1}));
  Gap gap(std::move(two));
  for (const Vec3& corner : {Vec3{0.5, 0.5, 1}, {2.5, 0.5, 1}, {2.5, 0.8, 1}, {0.5, 0.8, 1}}) gap.add(corner, kZ);
  EXPECT_FALSE(gap.filled(4));
}

TEST(FillGap, TurnsNothingOver) {
  Gap gap;
  for (const Vec3& corner : {Vec3{0.1, 0.1, 1}, {0.1, 0.9, 1}, {0.9, 0.9, 1}, {0.9, 0.1, 1}}) gap.add(corner, kZ);
  EXPECT_FALSE(gap.filled(4));
}

}  // namespace
}  // namespace raycone
