#include "core/far/shared_corners.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "core/boundary/solid_angles.h"
#include "core/boundary/winding_number_engine.h"
#include "core/machine/floating_point.h"
#include "tests/support/differences.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

constexpr std::array kLevels{SimdLevel::kSse4, SimdLevel::kAvx2, SimdLevel::kAvx512};
constexpr double kStep = 1.0 / 64;

// A fan around a point, whose triangles share corners.
std::vector<SolidTriangle> fan_at(const Vec3& centre, double size) {
  test::Random random(7);
  TriangleMesh mesh{{centre}, {}};
  for (std::uint32_t n = 1; n <= 40; ++n) {
    Vec3 rim = centre;
    for (int axis = 0; axis < 3; ++axis) rim[axis] += size * test::uniform(random, -1, 1);
    mesh.vertices.push_back(rim);
    if (n > 1) mesh.triangles.push_back({0, n - 1, n});
  }
  return solid_faces(mesh).triangles;
}

// Rows of eight along x, at one z.
SampleTile rows(std::size_t count, const Vec3& first) {
  SampleTile tile;
  tile.clear();
  for (std::size_t n = 0; n < 8 * count; ++n) {
    tile.add(first + kStep * Vec3{static_cast<double>(n % 8), static_cast<double>(n / 8), 0.0});
  }
  return tile;
}

Box box_of(const SampleTile& tile) {
  Box box{tile.query(0), tile.query(0)};
  for (std::size_t i = 0; i < tile.count; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      box.lower[axis] = std::min(box.lower[axis], tile.query(i)[axis]);
      box.upper[axis] = std::max(box.upper[axis], tile.query(i)[axis]);
    }
  }
  return box;
}

std::vector<double> sums_of(std::span<const SolidTriangle> triangles, GroupLooks looks, const SampleTile& tile,
                            TileShape shape, SimdLevel level, Care care = Care::kFull) {
  const DefaultFloatingPoint guard;
  SharedCorners corners = SharedCorners(triangles);
  corners.add_group(triangles.size(), looks);
  ProductTile products;
  shared_corners_kernel(level, care)(corners, tile, shape, products);
  std::vector<double> sums(tile.count);
  for (std::size_t i = 0; i < tile.count; ++i) {
    sums[i] = static_cast<double>(products.turns(i)) + products.argument[i];
  }
  return sums;
}

bool all_look_small(std::span<const SolidTriangle> triangles, const Box& box) {
  return std::ranges::all_of(triangles, [&](const SolidTriangle& t) { return looks_small_from(t, box); });
}

// The fan's corners lie among the samples, some on them, so that many factors are ties or not to be trusted.
TEST(SharedCorners, RowsHaveTheBitsOfScatteredSamples) {
  const std::vector<SolidTriangle> triangles = fan_at({4 * kStep, 3 * kStep, 0.0}, 0.1);
  for (const std::size_t count : {1U, 3U, 8U}) {
    const SampleTile tile = rows(count, {0.0, 0.0, 0.0});
    ASSERT_FALSE(all_look_small(triangles, box_of(tile)));
    const std::vector<double> scattered =
        sums_of(triangles, GroupLooks::kAny, tile, TileShape::kScattered, SimdLevel::kSse4);
    for (const SimdLevel level : kLevels) {
      EXPECT_EQ(sums_of(triangles, GroupLooks::kAny, tile, TileShape::kInRows, level), scattered);
      EXPECT_EQ(sums_of(triangles, GroupLooks::kAny, tile, TileShape::kScattered, level), scattered);
    }
  }
}

// Triangles a million times as long as they are far away from samples: that is where factors cancel.
TEST(SharedCorners, RoughFactorsAreOffByNoMoreThanTheyMayBe) {
  std::vector<SolidTriangle> triangles;
  test::Random random(3);
  for (int n = 0; n < 20; ++n) {
    const Vec3 a{-1, test::uniform(random, -1, 1), 1e-6 * n}, b{1.5, test::uniform(random, -1, 1), 2e-6};
    triangles.push_back(solid_faces({{a, b, a + Vec3{0.0, 1e-4 * n, 1e-3}}, {{0, 1, 2}}}).triangles.front());
  }
  const double most = kRoughness * doubt_of_factors(3 * static_cast<double>(triangles.size()));
  double largest = 0.0;
  for (int n = 0; n < 500; ++n) {
    const SolidTriangle& t = triangles[random() % triangles.size()];
    const Vec3 near = t.a + test::uniform(random, 0, 1) * (t.b - t.a);
    const double away = std::pow(10.0, test::uniform(random, -7, -1));
    SampleTile tile;
    tile.clear();
    for (int i = 0; i < 64; ++i) {
      tile.add(near + away * test::uniform_point(random, {{-1, -1, -1}, {1, 1, 1}}));
    }
    const std::vector<double> full =
        sums_of(triangles, GroupLooks::kAny, tile, TileShape::kScattered, SimdLevel::kBest);
    for (const SimdLevel level : kLevels) {
      const std::vector<double> rough =
          sums_of(triangles, GroupLooks::kAny, tile, TileShape::kScattered, level, Care::kRough);
      largest = std::max(largest, test::largest_difference(full, rough));
    }
  }
  EXPECT_LE(largest, most);
  EXPECT_GT(largest, 1e-5 * most) << "the control: they are rough";
}

// What is known to look small is not looked at again, and multiplied by eights: sums change by rounding alone.
TEST(SharedCorners, TrianglesThatLookSmallNeedNoSecondLook) {
  // Not much nearer, they would not look small: arguments are about as large as they can be.
  const std::vector<SolidTriangle> triangles = fan_at({0.44, 0.0, 0.1}, 0.1);
  const SampleTile tile = rows(8, {0.0, 0.0, 0.0});
  ASSERT_TRUE(all_look_small(triangles, box_of(tile)));
  const std::vector<double> looked_at =
      sums_of(triangles, GroupLooks::kAny, tile, TileShape::kScattered, SimdLevel::kSse4);
  const double doubt = doubt_of_factors(3 * static_cast<double>(triangles.size()));
  const std::vector<double> sums =
      sums_of(triangles, GroupLooks::kSmall, tile, TileShape::kScattered, SimdLevel::kSse4);
  for (std::size_t i = 0; i < sums.size(); ++i) EXPECT_NEAR(sums[i], looked_at[i], doubt);
  for (const SimdLevel level : kLevels) {
    for (const TileShape shape : {TileShape::kScattered, TileShape::kInRows}) {
      EXPECT_EQ(sums_of(triangles, GroupLooks::kSmall, tile, shape, level), sums);
    }
  }
  // The control: among the triangles, the second look is needed.
  const std::vector<SolidTriangle> around = fan_at({4 * kStep, 3 * kStep, 0.0}, 0.1);
  EXPECT_NE(sums_of(around, GroupLooks::kSmall, tile, TileShape::kInRows, SimdLevel::kBest),
            sums_of(around, GroupLooks::kAny, tile, TileShape::kInRows, SimdLevel::kBest));
}

// Thousands of triangles around the samples: no turn must be lost.
TEST(SharedCorners, ManySmallTrianglesSumToTurns) {
  const std::vector<SolidTriangle> triangles = solid_faces(test::sphere(64)).triangles;
  SampleTile tile;
  tile.clear();
  for (int i = 0; i < 64; ++i) tile.add({1e-3 * (i % 8), 1e-3 * (i / 8), 0.0});
  ASSERT_TRUE(all_look_small(triangles, box_of(tile)));
  const double doubt = doubt_of_factors(3 * static_cast<double>(triangles.size()));
  for (const SimdLevel level : kLevels) {
    for (const double sum : sums_of(triangles, GroupLooks::kSmall, tile, TileShape::kScattered, level))
      EXPECT_NEAR(sum, 1.0, doubt);
  }
}

TEST(SharedCorners, ATriangleLooksSmallBeyondItsLongestSide) {
  const SolidTriangle triangle = fan_at({0.0, 0.0, 0.0}, 0.1).front();
  double longest = 0.0;
  for (const Vec3& side : {triangle.b - triangle.a, triangle.c - triangle.b, triangle.a - triangle.c}) {
    longest = std::max(longest, std::sqrt(dot(side, side)));
  }
  const double right = std::max({triangle.a.x, triangle.b.x, triangle.c.x});
  const auto plane_at = [](double x) { return Box{{x, -1.0, -1.0}, {x, 1.0, 1.0}}; };
  EXPECT_FALSE(looks_small_from(triangle, plane_at(right + 0.99 * longest)));
  EXPECT_TRUE(looks_small_from(triangle, plane_at(right + 1.01 * longest)));
}

}  // namespace
}  // namespace raycone
