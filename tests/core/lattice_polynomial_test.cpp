#include "core/evaluation/lattice_polynomial.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/differences.h"
#include "tests/support/lattice_rows.h"
#include "tests/support/shapes.h"

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
          off = test::larger_difference(off, std::abs(at(nodes, values, i) - values[i]));
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

// ---- Grids of nodes ----------------------------------------------------------------------------------------------

LatticeRows rows_of(std::int64_t nx, std::int64_t ny, std::int64_t nz) {
  return test::rows_of({{0.3, 0.3, 0.3}, {0.01, 0.013, 0.02}, {0, 0, 0}, {nx, ny, nz}});
}

// 1 / |p - pole|: derivatives of order k along any direction are at most k! / |p - pole|^(k+1).
TEST(NodeGrid, IsOffByNoMoreThanItsBend) {
  const LatticeRows rows = rows_of(40, 21, 9);
  const SampleBox box{{3, 2, 1}, {37, 20, 9}}, part{{11, 5, 2}, {30, 17, 9}};
  const Box space = rows.box_of(box);
  const Vec3 pole = space.upper + Vec3{0.2, 0.3, 0.1};
  const auto value = [&](const std::array<std::size_t, 3>& sample) { return 1 / norm(rows.query(sample) - pole); };
  std::vector<double> derivatives;
  for (int k = 1; k <= 8; ++k) derivatives.push_back(std::pow(1 / norm(space.upper - pole), k + 1));
  for (const std::array<std::size_t, 3>& degrees :
       {std::array<std::size_t, 3>{0, 0, 0}, {1, 2, 3}, {4, 3, 2}, {7, 7, 7}, {5, 0, 6}}) {
    const NodeGrid grid(rows, box, degrees, derivatives);
    ASSERT_EQ(grid.size(), (degrees[0] + 1) * (degrees[1] + 1) * (degrees[2] + 1));
    std::vector<double> values;
    for (const std::array<std::size_t, 3>& node : grid.nodes()) values.push_back(value(node));
    ASSERT_EQ(values.size(), grid.size());
    double off = 0.0;
    LayerValues layer;
    for (std::size_t k = part.begin[2]; k < part.end[2]; ++k) {
      grid.interpolate(values, part, k, matrix_kernel(SimdLevel::kBest), layer);
      for (std::size_t j = part.begin[1]; j < part.end[1]; ++j) {
        for (std::size_t i = part.begin[0]; i < part.end[0]; ++i) {
          const double here = layer.values[(j - part.begin[1]) * layer.width + i - part.begin[0]];
          off = test::larger_difference(off, std::abs(here - value({i, j, k})));
          EXPECT_NEAR(here, grid.at(values, {i, j, k}), 1e-12);
        }
      }
    }
    EXPECT_LE(off, grid.bend());
    EXPECT_GT(off, grid.bend() / 1000);
  }
}

TEST(NodeGrid, TellsTheValuesAtTheNodesOfAPart) {
  const LatticeRows rows = rows_of(30, 20, 10);
  const std::vector<double> unit(8, 1.0);
  const NodeGrid grid(rows, {{1, 2, 0}, {30, 20, 10}}, {3, 4, 2}, unit);
  test::Random random(5);
  std::vector<double> values(grid.size());
  for (double& value : values) value = test::uniform(random, -1, 1);
  for (const SampleBox& box : {SampleBox{{5, 4, 3}, {17, 16, 9}}, SampleBox{{1, 2, 9}, {30, 3, 10}}}) {
    const NodeGrid part(rows, box, {3, 2, 4}, unit);
    const std::vector<double> of_part = grid.at_nodes_of(part, values);
    const auto nodes = part.nodes();
    ASSERT_EQ(of_part.size(), nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) EXPECT_NEAR(of_part[n], grid.at(values, nodes[n]), 1e-13);
  }
}

// Values at nodes that are off by 1, with the signs of a sample's weights.
TEST(NodeGrid, GrowsErrorsByNoMoreThanItSays) {
  const LatticeRows rows = rows_of(30, 20, 10);
  const SampleBox box{{0, 0, 0}, {30, 20, 10}};
  const NodeGrid grid(rows, box, {5, 4, 3}, std::vector<double>(8, 1.0));
  double largest = 0.0;
  for (const std::array<std::size_t, 3>& sample : {std::array<std::size_t, 3>{0, 0, 0}, {1, 1, 1}, {14, 9, 5}}) {
    double sum = 0.0;
    for (std::size_t n = 0; n < grid.size(); ++n) {
      std::vector<double> one(grid.size());
      one[n] = 1.0;
      sum += std::abs(grid.at(one, sample));
    }
    largest = std::max(largest, sum);
  }
  EXPECT_LE(largest, grid.growth());
  EXPECT_GT(largest, grid.growth() / 8);
}

}  // namespace
}  // namespace raycone
