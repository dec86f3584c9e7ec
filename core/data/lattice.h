// Regular lattices of sample points.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/data/vec3.h"

namespace raycone {

// Of a sample, along x, y and z.
using LatticeIndex = std::array<std::int64_t, 3>;

// The samples with indices index_min[a] <= index < index_min[a] + counts[a] along each axis a. An index has the
// coordinate origin + index * spacing. Product and sum are each rounded to double, so that samples lie exactly where
// they are said to lie.
struct Lattice {
  Vec3 origin;   // world position of index (0, 0, 0), which need not be a sample
  Vec3 spacing;  // world units per index step, positive
  LatticeIndex index_min{0, 0, 0};
  std::array<std::int64_t, 3> counts{1, 1, 1};  // each at least 1

  [[nodiscard]] double coordinate(int axis, std::int64_t index) const {
    const double step = static_cast<double>(index) * spacing[axis];
    return origin[axis] + step;
  }
  [[nodiscard]] Vec3 position(const LatticeIndex& index) const {
    return {coordinate(0, index[0]), coordinate(1, index[1]), coordinate(2, index[2])};
  }
  [[nodiscard]] std::int64_t index_max(int axis) const {
    const auto a = static_cast<std::size_t>(axis);
    return index_min[a] + (counts[a] - 1);
  }
  // In floating point: the number may not fit in 64 bits.
  [[nodiscard]] double samples() const {
    return static_cast<double>(counts[0]) * static_cast<double>(counts[1]) * static_cast<double>(counts[2]);
  }
  [[nodiscard]] double least_spacing() const { return std::min({spacing.x, spacing.y, spacing.z}); }
  [[nodiscard]] double largest_spacing() const { return std::max({spacing.x, spacing.y, spacing.z}); }

  // The inverse of coordinate(), up to rounding: an index that need not be whole. Of two coordinates, the larger one
  // never has the smaller index.
  [[nodiscard]] double index_at(int axis, double coordinate) const {
    return (coordinate - origin[axis]) / spacing[axis];
  }
  // The same from the first sample. Where that is many steps from the origin, this rounds less.
  [[nodiscard]] double steps_from_first(int axis, double coordinate) const {
    return (coordinate - this->coordinate(axis, index_min[static_cast<std::size_t>(axis)])) / spacing[axis];
  }
  [[nodiscard]] Vec3 steps_from_first(const Vec3& p) const {
    return {steps_from_first(0, p.x), steps_from_first(1, p.y), steps_from_first(2, p.z)};
  }
  // Cells are half-open, from one sample to the next, and numbered from 0 along each axis: the cell of an index, whole
  // or not. -1 is all that is before the first sample, `counts` all that is a step and more behind the last one.
  // Precondition: the index is not NaN, and `counts` is at most 2^62.
  [[nodiscard]] std::int64_t cell_of(int axis, double index) const {
    const auto a = static_cast<std::size_t>(axis);
    const double cell = std::floor(index) - static_cast<double>(index_min[a]);
    return static_cast<std::int64_t>(std::clamp(cell, -1.0, static_cast<double>(counts[a])));
  }
  // Which of two cells a coordinate next to their common sample is in may be up to rounding.
  [[nodiscard]] std::int64_t cell_at(int axis, double coordinate) const {
    return cell_of(axis, index_at(axis, coordinate));
  }
};

// The largest magnitude of a coordinate of its samples.
[[nodiscard]] inline double largest_coordinate(const Lattice& lattice) {
  return std::max(
      largest_coordinate(lattice.position(lattice.index_min)),
      largest_coordinate(lattice.position({lattice.index_max(0), lattice.index_max(1), lattice.index_max(2)})));
}

// Evaluators count the samples along an axis of a block in 32 bits.
inline constexpr std::int64_t kMaxBlockSide = 0xFFFFFFFF;

// A box of samples: along each axis a those with first[a] <= index < first[a] + counts[a]. These are indices of the
// lattice, so first >= index_min. The values of a block are stored x fastest, then y, then z.
struct LatticeBlock {
  LatticeIndex first{0, 0, 0};
  std::array<std::int64_t, 3> counts{0, 0, 0};

  [[nodiscard]] std::int64_t size() const { return counts[0] * counts[1] * counts[2]; }
  [[nodiscard]] bool holds(const LatticeIndex& index) const {
    for (std::size_t a = 0; a < 3; ++a) {
      if (index[a] < first[a] || index[a] >= first[a] + counts[a]) return false;
    }
    return true;
  }
  // Of a sample that it holds, counted from 0 in the order of values.
  [[nodiscard]] std::size_t number_of(const LatticeIndex& index) const {
    const auto behind = [&](std::size_t a) { return index[a] - first[a]; };
    return static_cast<std::size_t>((behind(2) * counts[1] + behind(1)) * counts[0] + behind(0));
  }
  // The sample of this number.
  [[nodiscard]] LatticeIndex index_of(std::size_t number) const {
    const auto n = static_cast<std::int64_t>(number);
    const std::int64_t row = n / counts[0];
    return {first[0] + n % counts[0], first[1] + row % counts[1], first[2] + row / counts[1]};
  }
};

[[nodiscard]] inline LatticeBlock whole(const Lattice& lattice) { return {lattice.index_min, lattice.counts}; }

// Calls visit(index) for the samples of a block, in the order of values.
template <class Visit>
void for_each_sample(const LatticeBlock& block, const Visit& visit) {
  for (std::int64_t k = block.first[2]; k < block.first[2] + block.counts[2]; ++k) {
    for (std::int64_t j = block.first[1]; j < block.first[1] + block.counts[1]; ++j) {
      for (std::int64_t i = block.first[0]; i < block.first[0] + block.counts[0]; ++i) visit(LatticeIndex{i, j, k});
    }
  }
}

}  // namespace raycone
