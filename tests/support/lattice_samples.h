// The samples of lattices as points.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/lattice.h"

namespace raycone::test {

// Of a block, x fastest.
[[nodiscard]] inline std::vector<Vec3> samples_of(const Lattice& lattice, const LatticeBlock& block) {
  std::vector<Vec3> points;
  for (std::int64_t k = block.first[2]; k < block.first[2] + block.counts[2]; ++k) {
    for (std::int64_t j = block.first[1]; j < block.first[1] + block.counts[1]; ++j) {
      for (std::int64_t i = block.first[0]; i < block.first[0] + block.counts[0]; ++i) {
        points.push_back({lattice.coordinate(0, i), lattice.coordinate(1, j), lattice.coordinate(2, k)});
      }
    }
  }
  return points;
}

// Of all of it.
[[nodiscard]] inline std::vector<Vec3> samples_of(const Lattice& lattice) {
  return samples_of(lattice, whole(lattice));
}

}  // namespace raycone::test
