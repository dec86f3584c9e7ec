// The inner loop of enclosures: products of factors in pairs of doubles over many samples at once, in SIMD lanes.
#pragma once

#include <span>

#include "core/boundary/chain.h"
#include "core/boundary/sample_tile.h"
#include "core/machine/simd.h"

namespace raycone {

// A part of a product that is below this stands for 0, with its sign.
inline constexpr double kNoPart = 0x1p-900;

// Per sample the product of the factors, the larger part in [1, 2), the turns that its argument has completed, and a
// bound of that argument's error in radians: infinite where a factor is out of the range of pairs of doubles.
struct PairProductTile {
  alignas(64) Tile re_high, re_low;
  alignas(64) Tile im_high, im_low;
  alignas(64) Tile turns;  // integers
  alignas(64) Tile error;
};

// Multiplies the factors of all edges at all samples. The same bits for every SIMD level. Needs DefaultFloatingPoint.
// Thread-safe.
using EnclosureKernel = void (*)(std::span<const ChainStep> steps, const SampleTile& samples,
                                 PairProductTile& products);

// That of the level, of the best one where the level is not available.
[[nodiscard]] EnclosureKernel enclosure_kernel(SimdLevel level);

}  // namespace raycone
