// Blocks of scattered points: winding numbers against direct sums, and polynomials against those of grids.
#include "core/far/point_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/boundary/solid_angles.h"
#include "core/evaluation/winding_number.h"
#include "core/far/polynomial_kernel.h"
#include "core/mesh/weld.h"
#include "tests/support/differences.h"
#include "tests/support/shapes.h"
#include "tests/support/values.h"

namespace raycone {
namespace {

using test::Random;

constexpr double kPoints = 60'000;

TriangleMesh loose_triangles() {
  Random random(3);
  return weld(test::dust(random, 400), {});
}

WindingNumberEvaluator evaluator_of(const TriangleMesh& mesh, double tolerance, SimdLevel level = SimdLevel::kBest) {
  return WindingNumberEvaluator(mesh, {.level = level,
                                       .summation = Summation::kBlocks,
                                       .accuracy = {.tolerance = tolerance, .samples = kPoints, .points = kPoints}});
}

// In the mesh's box and around it, also far outside of the blocks.
std::vector<Vec3> some_points(const TriangleMesh& mesh, std::size_t count) {
  Random random(4);
  const Box box = bounding_box(mesh);
  const Vec3 size = box.upper - box.lower;
  std::vector<Vec3> points;
  while (points.size() < count) {
    const double room = points.size() % 8 == 0 ? 0.6 : 0.05;
    points.push_back(test::uniform_point(random, {box.lower - room * size, box.upper + room * size}));
  }
  for (const Vec3& v : mesh.vertices) points.push_back(v);
  return points;
}

TEST(PointBlocksTest, ValuesAreWithinTheToleranceOfTheDirectSum) {
  for (const TriangleMesh& mesh : {test::sieve(30, 5), loose_triangles()}) {
    const std::vector<Vec3> points = some_points(mesh, 6000);
    const std::vector<double> direct = test::values_of(evaluator_of(mesh, 0.0), points);
    for (const double tolerance : {1e-4, 1e-7, 1e-10}) {
      const WindingNumberEvaluator blocks = evaluator_of(mesh, tolerance);
      const std::vector<double> values = test::values_of(blocks, points);
      EXPECT_GE(blocks.terms().far, points.size() / 2);  // the polynomial of each that is not outside
      double largest = 0.0;
      for (std::size_t n = 0; n < values.size(); ++n) {
        largest = test::larger_difference(largest, std::abs(values[n] - direct[n]));
        EXPECT_EQ(values[n] > 0.5, direct[n] > 0.5);
      }
      EXPECT_LE(largest, tolerance);
      EXPECT_GT(largest, tolerance * 1e-6);
    }
  }
}

TEST(PointBlocksTest, AQueryHasTheSameBitsAnywhere) {
  const TriangleMesh mesh = test::sieve(30, 5);
  const std::vector<Vec3> points = some_points(mesh, 3000);
  const std::vector<double> values = test::values_of(evaluator_of(mesh, 1e-8), points);
  for (const SimdLevel level : {SimdLevel::kSse4, SimdLevel::kAvx2}) {
    EXPECT_EQ(test::values_of(evaluator_of(mesh, 1e-8, level), points), values);
  }
  const WindingNumberEvaluator evaluator = evaluator_of(mesh, 1e-8);
  std::vector<Vec3> some;
  std::vector<double> expected;
  for (std::size_t n = points.size(); n-- > 0;) {
    if (n % 7 != 0) continue;
    some.push_back(points[n]);
    expected.push_back(values[n]);
  }
  EXPECT_EQ(test::values_of(evaluator, some), expected);
  for (std::size_t n = 0; n < 5; ++n) EXPECT_EQ(test::values_of(evaluator, {&points[n], 1}), std::vector{values[n]});
}

TEST(PointBlocksTest, HalfIntegersStayHalfIntegers) {
  // The rim is in one plane: there, the winding number is a half-integer or 0.
  const TriangleMesh mesh = test::notched_fan();
  Random random(7);
  std::vector<Vec3> points;
  while (points.size() < 2000) points.push_back(test::uniform_point(random, {{-0.5, -0.5, 0.0}, {0.5, 0.5, 0.0}}));
  const std::vector<double> direct = test::values_of(evaluator_of(mesh, 0.0), points);
  EXPECT_GT(std::ranges::count_if(direct, [](double w) { return std::abs(w) == 0.5; }), 100);
  for (const double tolerance : {1e-3, 1e-9}) {
    const WindingNumberEvaluator blocks = evaluator_of(mesh, tolerance);
    const std::vector<double> values = test::values_of(blocks, points);
    EXPECT_GT(blocks.terms().far, points.size());
    for (std::size_t n = 0; n < values.size(); ++n) {
      EXPECT_EQ(values[n] == 0.5, direct[n] == 0.5);
      EXPECT_EQ(values[n] > 0.5, direct[n] > 0.5);
    }
  }
}

TEST(PointBlocksTest, PointsAtTheEndsOfCellsAreInTheBoxesOfTheirGroups) {
  Random random(5);
  const LatticeBlocks sums(solid_faces(loose_triangles()).triangles, 1e-6, SimdLevel::kBest);
  const Box box{{-0.3, -0.7, 0.1}, {0.4, 0.9, 0.1}};  // flat
  const PointBlocks blocks(sums, box, 1e4);
  EXPECT_GT(blocks.groups(), 10U);
  EXPECT_TRUE(blocks.group_of(box.lower));
  EXPECT_TRUE(blocks.group_of(box.upper));
  EXPECT_FALSE(blocks.group_of({0.0, 0.0, 0.2}));
  EXPECT_FALSE(blocks.group_of({0.0, std::nan(""), 0.1}));
  for (int n = 0; n < 1000; ++n) {
    const auto group = blocks.group_of(test::uniform_point(random, box));
    ASSERT_TRUE(group);
    EXPECT_LT(*group, blocks.groups());
  }
}

TEST(PolynomialKernelTest, HasTheValuesOfGridsAndTheSameBitsAtAllLevels) {
  Random random(6);
  Coefficients polynomial{};
  for (std::size_t k = 0; k < kTerms; ++k) {
    for (std::size_t j = 0; j + k < kTerms; ++j) {
      for (std::size_t i = 0; i + j + k < kTerms; ++i) {
        polynomial[kRows.begin(j, k) + i] = test::uniform(random, -1e-3, 1e-3);
      }
    }
  }
  const Cube cube{{0.1, -0.2, 0.3}, 0.5};
  GridValues grid(matrix_kernel(SimdLevel::kBest));
  for (const std::size_t degree : {std::size_t{0}, std::size_t{7}, kDegree}) {
    for (const std::size_t count : {1U, 8U, 23U, 64U}) {
      SampleTile tile;
      tile.clear();
      while (tile.count < count) {
        tile.add(test::uniform_point(random, {{-0.4, -0.7, -0.2}, {0.6, 0.3, 0.8}}));
      }
      tile.fill_up();
      alignas(64) Tile values{}, at_level{};
      polynomial_kernel(SimdLevel::kBest)(polynomial, degree, cube, tile, values);
      for (const SimdLevel level : {SimdLevel::kSse4, SimdLevel::kAvx2, SimdLevel::kAvx512}) {
        polynomial_kernel(level)(polynomial, degree, cube, tile, at_level);
        EXPECT_EQ(at_level, values);
      }
      for (std::size_t n = 0; n < count; ++n) {
        const auto expected =
            grid.evaluate(polynomial, degree, cube, {&tile.x[n], 1}, {&tile.y[n], 1}, {&tile.z[n], 1});
        EXPECT_NEAR(values[n], expected[0], 1e-13);
      }
    }
  }
}

}  // namespace
}  // namespace raycone
