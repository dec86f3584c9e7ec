#include "core/far/matrix_kernel.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "core/machine/simd.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::Random;

TEST(MatrixKernelTest, LevelsHaveTheSameBits) {
  Random random(5);
  std::vector<double> a(23 * 9), b(23 * 16);
  for (double& number : a) number = test::uniform(random, -1, 1);
  for (double& number : b) number = test::uniform(random, -1, 1);
  std::vector<std::vector<double>> results;
  for (const SimdLevel level : {SimdLevel::kSse4, SimdLevel::kAvx2, SimdLevel::kAvx512}) {
    std::vector<double>& out = results.emplace_back(9 * 16);
    matrix_kernel(level).multiply({a.data(), 23, 1}, {b.data(), 16}, {out.data(), 16}, 9, 23, 16);
    EXPECT_EQ(out, results.front());
  }
  double sum = 0.0;
  for (std::size_t k = 0; k < 23; ++k) sum += a[5 * 23 + k] * b[k * 16 + 3];
  EXPECT_EQ(results.front()[5 * 16 + 3], sum);
}

TEST(MatrixKernelTest, RowsOfAnyDepthHaveTheBitsOfOneByOne) {
  Random random(6);
  std::vector<double> a(23 * 11), b(23 * 16);
  for (double& number : a) number = test::uniform(random, -1, 1);
  for (double& number : b) number = test::uniform(random, -1, 1);
  for (const SimdLevel level : {SimdLevel::kSse4, SimdLevel::kAvx2, SimdLevel::kAvx512}) {
    std::vector<double> out(11 * 16), one(11 * 16);
    std::vector<RaggedRow> rows;
    for (std::size_t r = 0; r < 11; ++r) rows.push_back({&a[r * 23], (5 * r + 3) % 24, &out[r * 16]});
    matrix_kernel(level).multiply_ragged(rows, {b.data(), 16}, 16);
    for (std::size_t r = 0; r < 11; ++r) {
      matrix_kernel(level).multiply({&a[r * 23], 0, 1}, {b.data(), 16}, {&one[r * 16], 16}, 1, rows[r].depth, 16);
    }
    EXPECT_EQ(out, one);
  }
}

}  // namespace
}  // namespace raycone
