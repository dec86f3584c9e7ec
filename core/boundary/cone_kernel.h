// The inner loop of the boundary cone: products of factors over many samples at once, in SIMD lanes.
#pragma once

#include <span>

#include "core/boundary/chain.h"
#include "core/boundary/sample_tile.h"
#include "core/machine/simd.h"

namespace raycone {

// Multiplies the factors of all edges at all samples. One lane is one sample, and its operations come in one order,
// without fused multiply-add: results are the same for every SIMD level. Needs DefaultFloatingPoint. Thread-safe.
using ConeKernel = void (*)(std::span<const ChainStep> steps, const SampleTile& samples, TileShape shape,
                            ProductTile& products);

// That of the level, of the best one where the level is not available.
[[nodiscard]] ConeKernel cone_kernel(SimdLevel level);

}  // namespace raycone
