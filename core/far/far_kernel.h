// The inner loops of the far field: multipoles and near triangles at many samples at once, in SIMD lanes.
#pragma once

#include <cstdint>

#include "core/boundary/sample_tile.h"
#include "core/far/source_tree.h"
#include "core/machine/simd.h"

namespace raycone {

// What a tree does to samples: w is the argument of the product of the near triangles' factors, with its turns, plus
// `far`.
struct FarTile {
  ProductTile near;
  alignas(64) Tile far;
  std::uint64_t near_terms = 0, far_terms = 0;  // pairs of samples with triangles, and with multipoles
};

// One lane is one sample: its operations come in one order, without fused multiply-add, and which nodes are far is its
// own affair. Results are the same for every SIMD level and in any tile. They need DefaultFloatingPoint. Thread-safe.
struct FarKernel {
  // Sets `result` for the samples, which are filled up.
  void (*sum)(const SourceTree& tree, const SampleTile& samples, FarTile& result);
  // Adds the expansion of node `number`, cut off behind degree p <= its order, at all samples, to values.
  void (*add_multipole)(const SourceTree& tree, std::uint32_t number, int p, const SampleTile& samples, Tile& values);
};

// That of the level, of the best one where the level is not available.
[[nodiscard]] FarKernel far_kernel(SimdLevel level);

}  // namespace raycone
