#include "core/boundary/cone_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/machine/floating_point.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

double in_turns(double re, double im) {
  return static_cast<double>(std::atan2(static_cast<long double>(im), static_cast<long double>(re)) /
                             (2 * std::numbers::pi_v<long double>));
}

// In all quadrants and octants, and at turns of all numbers of edges.
TEST(ConeKernel, GivesTheArgumentOfItsProduct) {
  const DefaultFloatingPoint guard;
  test::Random random(1);
  const Box box{{-1, -1, -1}, {1, 1, 1}};
  int octants = 0;
  for (const SimdLevel level : {SimdLevel::kSse4, SimdLevel::kAvx2, SimdLevel::kAvx512, SimdLevel::kBest}) {
    if (!is_available(level)) continue;
    for (std::size_t edges = 1; edges < 150; ++edges) {
      std::vector<ChainStep> steps{{test::uniform_point(random, box), false, false}};
      for (std::size_t i = 0; i < edges; ++i) steps.push_back({test::uniform_point(random, box), true, i % 3 == 0});
      SampleTile samples;
      for (std::size_t i = 0; i < 1 + edges % kTile; ++i) samples.add(test::uniform_point(random, box));
      samples.fill_up();
      ProductTile products;
      cone_kernel(level)(steps, samples, TileShape::kScattered, products);
      for (std::size_t i = 0; i < samples.count; ++i) {
        const double re = products.re[i], im = products.im[i];
        const double expected = in_turns(re, im);
        // Less than the 9 u that are proved, as roundings hardly ever all go one way: 5.5 u is the most that was found.
        ASSERT_NEAR(products.argument[i], expected, std::abs(expected) * 6 * 0x1p-53) << re << ' ' << im;
        ASSERT_EQ(std::signbit(products.argument[i]), std::signbit(im));
        octants |= 1 << ((re < 0) + 2 * (im < 0) + 4 * (std::abs(im) < std::abs(re)));
      }
    }
  }
  EXPECT_EQ(octants, 0xFF);
}

// Small arguments have as many digits as large ones: the edge is far off the rays.
TEST(ConeKernel, GivesSmallArgumentsToo) {
  const DefaultFloatingPoint guard;
  test::Random random(3);
  const Box box{{-1, -1, -1}, {1, 1, 1}};
  for (int i = 0; i < 2000; ++i) {
    const Vec3 away{0, std::exp2(test::uniform(random, 0, 40)), 0};
    const std::vector<ChainStep> steps{{away + test::uniform_point(random, box), false, false},
                                       {away + test::uniform_point(random, box), true, i % 2 == 0}};
    SampleTile samples;
    while (samples.count < kTile) samples.add(test::uniform_point(random, box));
    ProductTile products;
    cone_kernel(SimdLevel::kBest)(steps, samples, TileShape::kScattered, products);
    for (std::size_t n = 0; n < kTile; ++n) {
      const double expected = in_turns(products.re[n], products.im[n]);
      EXPECT_NEAR(products.argument[n], expected, std::abs(expected) * 6 * 0x1p-53);  // as above
    }
  }
}

// A sample in line with an edge: half a turn, with the sign of the edge's side, and none behind it.
TEST(ConeKernel, KeepsTheSignOfHalfATurn) {
  const DefaultFloatingPoint guard;
  for (const bool reversed : {false, true}) {
    const std::vector<ChainStep> steps{{{1, -1, -1}, false, false}, {{1, 1, 1}, true, reversed}};
    SampleTile samples;
    samples.add({0, 0, 0});
    samples.add({2, 0, 0});
    samples.fill_up();
    ProductTile products;
    cone_kernel(SimdLevel::kBest)(steps, samples, TileShape::kScattered, products);
    EXPECT_EQ(products.argument[0], reversed ? 0.5 : -0.5);
    EXPECT_EQ(products.argument[1], 0.0);
  }
}

// Some samples are level with vertices, where the side of an edge is exact.
TEST(ConeKernel, RowsHaveTheBitsOfScatteredSamples) {
  const DefaultFloatingPoint guard;
  test::Random random(2);
  const Box box{{-1, -1, -1}, {1, 1, 1}};
  for (const SimdLevel level : {SimdLevel::kSse4, SimdLevel::kAvx2, SimdLevel::kAvx512}) {
    if (!is_available(level)) continue;
    for (std::size_t rows = 1; rows <= 8; ++rows) {
      std::vector<ChainStep> steps{{test::uniform_point(random, box), false, false}};
      for (std::size_t i = 0; i < 40 * rows; ++i) {
        steps.push_back({test::uniform_point(random, box), i % 11 != 0, i % 3 == 0});
      }
      SampleTile samples;
      const Vec3 first = steps[3].to;
      for (std::size_t j = 0; j < rows; ++j) {
        for (std::size_t i = 0; i < 8; ++i) {
          samples.add({first.x + 0.1 * static_cast<double>(i), first.y + 0.1 * static_cast<double>(j), first.z});
        }
      }
      ProductTile in_rows, scattered;
      cone_kernel(level)(steps, samples, TileShape::kInRows, in_rows);
      cone_kernel(level)(steps, samples, TileShape::kScattered, scattered);
      for (std::size_t i = 0; i < samples.count; ++i) {
        ASSERT_EQ(in_rows.re[i], scattered.re[i]);
        ASSERT_EQ(in_rows.im[i], scattered.im[i]);
        ASSERT_EQ(in_rows.passages[i], scattered.passages[i]);
        ASSERT_EQ(in_rows.argument[i], scattered.argument[i]);
      }
    }
  }
}

}  // namespace
}  // namespace raycone
