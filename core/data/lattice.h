// Regular lattices of sample points.
#pragma once

#include <array>
#include <cstdint>

#include "core/data/vec3.h"

namespace raycone {

// The samples with indices index_min[a] <= index < index_min[a] + counts[a] along each axis a. An index has the
// coordinate origin + index * spacing. Product and sum are each rounded to double, so that samples lie exactly where
// they are said to lie.
struct Lattice {
  Vec3 origin;   // world position of index (0, 0, 0), which need not be a sample
  Vec3 spacing;  // world units per index step, positive
  std::array<std::int64_t, 3> index_min{0, 0, 0};
  std::array<std::int64_t, 3> counts{1, 1, 1};  // each at least 1

  [[nodiscard]] double coordinate(int axis, std::int64_t index) const {
    const double step = static_cast<double>(index) * spacing[axis];
    return origin[axis] + step;
  }
  [[nodiscard]] Vec3 position(const std::array<std::int64_t, 3>& index) const {
    return {coordinate(0, index[0]), coordinate(1, index[1]), coordinate(2, index[2])};
  }
  [[nodiscard]] std::int64_t index_max(int axis) const {
    const auto a = static_cast<std::size_t>(axis);
    return index_min[a] + counts[a] - 1;
  }
};

// Evaluators count the samples along an axis of a block in 32 bits.
inline constexpr std::int64_t kMaxBlockSide = 0xFFFFFFFF;

// A box of samples: along each axis a those with first[a] <= index < first[a] + counts[a]. These are indices of the
// lattice, so first >= index_min. The values of a block are stored x fastest, then y, then z.
struct LatticeBlock {
  std::array<std::int64_t, 3> first{0, 0, 0};
  std::array<std::int64_t, 3> counts{0, 0, 0};

  [[nodiscard]] std::int64_t size() const { return counts[0] * counts[1] * counts[2]; }
  // In the lattice, of the sample `number`, counted from 0 in the order of values.
  [[nodiscard]] std::array<std::int64_t, 3> index_of(std::size_t number) const {
    const auto n = static_cast<std::int64_t>(number);
    const std::int64_t row = n / counts[0];
    return {first[0] + n % counts[0], first[1] + row % counts[1], first[2] + row / counts[1]};
  }
};

[[nodiscard]] inline LatticeBlock whole(const Lattice& lattice) { return {lattice.index_min, lattice.counts}; }

}  // namespace raycone
