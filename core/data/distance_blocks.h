// Distances of a block of a lattice, most of whose samples are beyond a band.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/data/lattice.h"

namespace raycone {

// Numbers are kept of blocks of 8^3 samples, from indices of the lattice that are multiples of 8, which have a sample
// in the band. That, and four bytes for each block of the lattice, is the memory. Blocks with the same place along y
// make up a strip, which one thread fills.
class DistanceBlocks {
 public:
  static constexpr std::int64_t kSide = 8;
  static constexpr std::size_t kSamples = 512;  // of a block, and its voxels beside the lattice

  // The place of a sample in its block: x fastest.
  [[nodiscard]] static constexpr std::size_t index_in_block(const LatticeIndex& sample) {
    const auto in_block = [](std::int64_t i) { return static_cast<std::size_t>(i & (kSide - 1)); };
    return (in_block(sample[2]) * kSide + in_block(sample[1])) * kSide + in_block(sample[0]);
  }

  // For the samples of `block`, all of them at `beyond` or more.
  void reset(const LatticeBlock& block, double beyond) {
    samples_ = block;
    beyond_ = beyond;
    for (std::size_t a = 0; a < 3; ++a) {
      first_[a] = block_of(block.first[a]);
      counts_[a] = block.counts[a] > 0 ? block_of(block.first[a] + block.counts[a] - 1) - first_[a] + 1 : 0;
    }
    strips_.resize(static_cast<std::size_t>(counts_[1]));
    for (Strip& strip : strips_) {
      strip.numbers.clear();
      strip.places.assign(static_cast<std::size_t>(counts_[0] * counts_[2]), kBeyond);
    }
  }

  [[nodiscard]] const LatticeBlock& samples() const { return samples_; }
  // The magnitude of what is beyond the band.
  [[nodiscard]] double beyond() const { return beyond_; }

  // The places of all blocks: their samples' indices divided by 8, rounded down.
  [[nodiscard]] LatticeBlock blocks() const { return {first_, counts_}; }
  [[nodiscard]] static std::int64_t block_of(std::int64_t index) { return index >> 3; }

  // The samples that the block at a place consists of.
  [[nodiscard]] LatticeBlock samples_of(const LatticeIndex& place) const {
    LatticeBlock part;
    for (std::size_t a = 0; a < 3; ++a) {
      part.first[a] = std::max(place[a] * kSide, samples_.first[a]);
      part.counts[a] = std::min((place[a] + 1) * kSide, samples_.first[a] + samples_.counts[a]) - part.first[a];
    }
    return part;
  }

  // The numbers of the block at a place, by index_in_block(); none where all are beyond the band.
  [[nodiscard]] std::span<const double> numbers(const LatticeIndex& place) const {
    const Strip& strip = strip_at(place[1]);
    const std::uint32_t number = strip.places[index_in_strip(place)];
    if (number == kBeyond) return {};
    return std::span(strip.numbers).subspan(number * kSamples, kSamples);
  }

  // Makes room for numbers of the block at a place, which has none. They are `beyond`. What was obtained of the strip
  // before is no longer valid.
  [[nodiscard]] std::span<double> add(const LatticeIndex& place) {
    Strip& strip = strips_[static_cast<std::size_t>(place[1] - first_[1])];
    const std::size_t at = strip.numbers.size();
    strip.places[index_in_strip(place)] = static_cast<std::uint32_t>(at / kSamples);
    strip.numbers.resize(at + kSamples, beyond_);
    return std::span(strip.numbers).subspan(at, kSamples);
  }

  [[nodiscard]] double at(const LatticeIndex& sample) const {
    const std::span<const double> all = numbers({block_of(sample[0]), block_of(sample[1]), block_of(sample[2])});
    return all.empty() ? beyond_ : all[index_in_block(sample)];
  }

 private:
  struct Strip {
    std::vector<std::uint32_t> places;  // in `numbers`, of each block
    std::vector<double> numbers;        // block by block
  };
  static constexpr std::uint32_t kBeyond = std::numeric_limits<std::uint32_t>::max();

  [[nodiscard]] const Strip& strip_at(std::int64_t y) const { return strips_[static_cast<std::size_t>(y - first_[1])]; }
  [[nodiscard]] std::size_t index_in_strip(const LatticeIndex& place) const {
    return static_cast<std::size_t>((place[2] - first_[2]) * counts_[0] + place[0] - first_[0]);
  }

  LatticeBlock samples_;
  double beyond_ = 0.0;
  LatticeIndex first_{};
  std::array<std::int64_t, 3> counts_{};
  std::vector<Strip> strips_;
};

// With signs: negative inside.
struct SignedBlocks {
  const DistanceBlocks& distances;
  std::span<const std::uint8_t> inside;  // 1 or 0, of each of distances.samples(), x fastest, then y, then z

  // `inside` of the samples of a row from `sample` on.
  [[nodiscard]] std::span<const std::uint8_t> inside_from(const LatticeIndex& sample) const {
    return inside.subspan(distances.samples().number_of(sample));
  }
  [[nodiscard]] double at(const LatticeIndex& sample) const {
    return inside_from(sample)[0] != 0 ? -distances.at(sample) : distances.at(sample);
  }
};

}  // namespace raycone
