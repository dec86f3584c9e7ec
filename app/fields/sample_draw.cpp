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
  const LatticeBlock all = whole(lattice.grid);
  std::size_t n = 0;  // in the block
  for_each_sample(block, [&](const LatticeIndex& index) {
    const std::size_t in_block = n++;
    const std::uint64_t number = all.number_of(index), rank = rank_of(number);
    if (!takes(rank)) return;
    const auto& [i, j, k] = index;
    DrawnSample sample = drawn_sample(number, rank, lattice.position(i, j, k), numbers, in_block);
    if (distances) sample.distance = distances->at(index);
    keep(sample);
  });
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
