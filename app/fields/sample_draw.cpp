#include "app/fields/sample_draw.h"

#include <algorithm>

#include "core/data/split_mix.h"
#include "io/files/ascii.h"

namespace raycone {
namespace {

// No two samples have one rank.
std::uint64_t rank_of(std::uint64_t number) { return split_mix((number + 1) * kSplitMixStep); }

bool by_rank(const DrawnSample& a, const DrawnSample& b) { return a.rank < b.rank; }

}  // namespace

DrawnSample drawn_sample(std::uint64_t number, std::uint64_t rank, const Vec3& point, const SampleNumbers& numbers,
                         std::size_t n) {
  DrawnSample sample{number, rank, point};
  if (!numbers.winding.empty()) sample.winding = numbers.winding[n];
  if (!numbers.inside.empty()) sample.inside = numbers.inside[n] != 0;
  if (!numbers.density.empty()) sample.density = numbers.density[n];
  if (!numbers.distance.empty()) sample.distance = numbers.distance[n];
  if (!numbers.solid.empty()) sample.solid = numbers.solid[n];
  if (!numbers.gradient.empty()) sample.gradient = numbers.gradient[n];
  if (!numbers.label.empty()) sample.label = numbers.label[n];
  return sample;
}

std::string position_text(const DrawnSample& sample) {
  return "sample " + std::to_string(sample.number) + " at (" + shortest_text(sample.point.x) + ", " +
         shortest_text(sample.point.y) + ", " + shortest_text(sample.point.z) + ")";
}

bool SampleDraw::takes(std::uint64_t rank) const {
  return samples_.size() < count_ || (count_ > 0 && rank < samples_.front().rank);
}

void SampleDraw::keep(const DrawnSample& sample) {
  if (samples_.size() == count_) {
    std::ranges::pop_heap(samples_, by_rank);
    samples_.pop_back();
  }
  samples_.push_back(sample);
  std::ranges::push_heap(samples_, by_rank);
}

void SampleDraw::offer(const PlacedLattice& lattice, const LatticeBlock& block, const SampleNumbers& numbers,
                       const SignedBlocks* distances) {
  if (count_ == 0) return;
  const auto layer = [&](std::size_t axis, std::int64_t index) {
    return static_cast<std::uint64_t>(index - lattice.grid.index_min[axis]);
  };
  const auto nx = static_cast<std::uint64_t>(lattice.grid.counts[0]);
  const auto ny = static_cast<std::uint64_t>(lattice.grid.counts[1]);
  std::size_t n = 0;
  for (std::int64_t k = block.first[2]; k < block.first[2] + block.counts[2]; ++k) {
    for (std::int64_t j = block.first[1]; j < block.first[1] + block.counts[1]; ++j) {
      for (std::int64_t i = block.first[0]; i < block.first[0] + block.counts[0]; ++i, ++n) {
        const std::uint64_t number = (layer(2, k) * ny + layer(1, j)) * nx + layer(0, i);
        const std::uint64_t rank = rank_of(number);
        if (!takes(rank)) continue;
        DrawnSample sample = drawn_sample(number, rank, lattice.position(i, j, k), numbers, n);
        if (distances) sample.distance = distances->at({i, j, k});
        keep(sample);
      }
    }
  }
}

void SampleDraw::offer(std::span<const Vec3> points, const SampleNumbers& numbers) {
  for (std::size_t n = 0; n < points.size(); ++n, ++points_) {
    const std::uint64_t rank = rank_of(points_);
    if (takes(rank)) keep(drawn_sample(points_, rank, points[n], numbers, n));
  }
}

std::vector<DrawnSample> SampleDraw::samples() const {
  std::vector<DrawnSample> result = samples_;
  std::ranges::sort(result, {}, &DrawnSample::number);
  return result;
}

}  // namespace raycone
