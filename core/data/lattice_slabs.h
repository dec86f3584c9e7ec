// Blocks of a lattice in slabs.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/data/lattice.h"

namespace raycone {

// Of a block, so many layers across an axis from the one with that number on, or as many as there are.
[[nodiscard]] inline LatticeBlock slab_of(LatticeBlock block, std::size_t axis, std::int64_t first,
                                          std::int64_t layers) {
  block.first[axis] += first;
  block.counts[axis] = std::min(layers, block.counts[axis] - first);
  return block;
}

// Calls visit(slab) for slabs of a block across z, one after the other: each is a layer, or at most so many samples.
template <class Visit>
void for_each_slab(const LatticeBlock& block, std::int64_t samples, const Visit& visit) {
  const std::int64_t layers = std::max<std::int64_t>(samples / (block.counts[0] * block.counts[1]), 1);
  for (std::int64_t first = 0; first < block.counts[2]; first += layers) visit(slab_of(block, 2, first, layers));
}

}  // namespace raycone
