#include "core/boundary/edge_time.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <iterator>
#include <limits>
#include <vector>

#include "core/boundary/chain.h"
#include "core/boundary/cone_kernel.h"
#include "core/boundary/sample_tile.h"
#include "core/machine/built_once.h"

namespace raycone {
namespace {

constexpr std::size_t kEdges = 256;

// A chain that winds about the samples.
std::vector<ChainStep> chain() {
  constexpr Vec3 kCorners[]{{2, 0, 0.5}, {0, 2, 0.5}, {-2, 0, 0.5}, {0, -2, 0.5}};
  std::vector<ChainStep> steps;
  for (std::size_t i = 0; i <= kEdges; ++i) steps.push_back({kCorners[i % std::size(kCorners)], i > 0, false});
  return steps;
}

SampleTile rows() {
  SampleTile samples;
  for (std::size_t i = 0; i < kTile; ++i) {
    samples.add({0.1 * static_cast<double>(i % 8), 0.1 * static_cast<double>(i / 8), 0.0});
  }
  samples.fill_up();
  return samples;
}

// The least of some times: what comes in between makes the others longer.
double measured(SimdLevel level) {
  using Clock = std::chrono::steady_clock;
  constexpr int kTimes = 64;
  const ConeKernel multiply = cone_kernel(level);
  const std::vector<ChainStep> steps = chain();
  const SampleTile samples = rows();
  ProductTile products;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kTimes; ++i) {
    const Clock::time_point start = Clock::now();
    multiply(steps, samples, TileShape::kInRows, products);
    least = std::min(least, std::chrono::duration<double>(Clock::now() - start).count());
  }
  return least / static_cast<double>(kEdges * kTile);
}

}  // namespace

double edge_seconds(SimdLevel level) {
  static const std::array<BuiltOnce<double>, 4> seconds;
  return seconds[static_cast<std::size_t>(level)].get([&] { return measured(level); });
}

}  // namespace raycone
