#include "core/boundary/cone_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/boundary/angle.h"
#include "core/machine/floating_point.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

// In all quadrants and octants, and at turns of all numbers of edges: bit for bit what one sample at a time would give.
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
        ASSERT_EQ(products.argument[i], argument_in_turns<double>(re, im)) << re << ' ' << im;
        octants |= 1 << ((re < 0) + 2 * (im < 0) + 4 * (std::abs(im) < std::abs(re)));
      }
    }
  }
  EXPECT_EQ(octants, 0xFF);
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
