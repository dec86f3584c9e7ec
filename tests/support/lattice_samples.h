// The samples of lattices as points.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/lattice.h"

namespace raycone::test {

// Of a block, x fastest.
[[nodiscard]] inline std::vector<Vec3> samples_of(const Lattice& lattice, const LatticeBlock& block) {
  std::vector<Vec3> points;
  for_each_sample(block, [&](const LatticeIndex& index) { points.push_back(lattice.position(index)); });
  return points;
}

// Of all of it.
[[nodiscard]] inline std::vector<Vec3> samples_of(const Lattice& lattice) {
  return samples_of(lattice, whole(lattice));
}

}  // namespace raycone::test
