#include "core/evaluation/lattice_polynomial.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace raycone {
namespace {

std::vector<double> coordinates(std::size_t count, double step) {
  std::vector<double> all;
  for (std::size_t i = 0; i < count; ++i) all.push_back(0.3 + step * static_cast<double>(i));
  return all;
}

double at(const AxisNodes& nodes, const std::vector<double>& values, std::size_t sample) {
  double sum = 0.0;
  for (std::size_t n = 0; n < nodes.nodes().size(); ++n) sum += nodes.weights(n)[sample] * values[nodes.nodes()[n]];
  return sum;
}

// 1 / (pole - x): its derivative of order k is k! / (pole - x)^(k+1), the largest one at the last sample.
TEST(AxisNodes, AreOffByNoMoreThanTheirBound) {
  for (const std::size_t count : {2U, 3U, 6U, 12U, 24U, 48U, 96U}) {
    for (std::size_t degree = 1; degree < 8; ++degree) {
      for (const double step : {0.01, 0x1p-300, 3e4}) {
        const std::vector<double> xs = coordinates(count, step);
        const AxisNodes nodes(xs, degree);
        ASSERT_EQ(nodes.nodes().size(), std::min(degree + 1, count));
        EXPECT_TRUE(std::ranges::is_sorted(nodes.nodes(), std::ranges::less_equal{}));
        if (!(xs[1] > xs[0])) {  // steps that vanish
          EXPECT_GT(nodes.growth(), 1e300);
          continue;
        }
        const double pole = xs.back() + 0.7 * (xs.back() - xs.front());
        std::vector<double> values;
        for (const double x : xs) values.push_back(1 / (pole - x));
        double off = 0.0, growth = 1.0;
        for (std::size_t i = 0; i < count; ++i) {
          off = std::max(off, std::abs(at(nodes, values, i) - values[i]));
          double sum = 0.0;
          for (std::size_t n = 0; n < nodes.nodes().size(); ++n) sum += std::abs(nodes.weights(n)[i]);
          growth = std::max(growth, sum);
        }
        const double bound = nodes.error(std::pow(1 / (pole - xs.back()), static_cast<double>(degree + 2)));
        const double rounding = 1e-13 * values.back() * growth;
        EXPECT_LE(off, bound + rounding) << count << " samples, degree " << degree;
        EXPECT_GE(nodes.growth(), growth);
        EXPECT_LT(nodes.growth(), 4.0);
        if (count <= degree + 1) {
          EXPECT_EQ(bound, 0.0);
          EXPECT_EQ(off, 0.0);
        } else {
          EXPECT_GT(off, bound / 100) << count << " samples, degree " << degree;
        }
      }
    }
  }
}

TEST(AxisNodes, OfOneSampleAreThatSample) {
  const AxisNodes nodes(std::vector<double>{0.5}, 3);
  ASSERT_EQ(nodes.nodes().size(), 1U);
  EXPECT_EQ(nodes.weights(0)[0], 1.0);
  EXPECT_EQ(nodes.error(1e300), 0.0);
  EXPECT_NEAR(nodes.growth(), 1.0, 1e-11);
}

// Products of distances that underflow: the bound is not 0.
TEST(AxisNodes, BoundWhatUnderflows) {
  std::vector<double> tiny;
  for (int i = 0; i < 20; ++i) tiny.push_back(std::ldexp(static_cast<double>(i), -400));
  EXPECT_GT(AxisNodes(tiny, 5).error(1e280), 0.0);
}

}  // namespace
}  // namespace raycone
