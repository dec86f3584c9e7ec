// The inner loop of polynomials at scattered points, in SIMD lanes.
#pragma once

#include <cstddef>

#include "core/boundary/sample_tile.h"
#include "core/far/harmonic_polynomial.h"
#include "core/machine/simd.h"

namespace raycone {

// values[i] = the polynomial up to the degree at sample i. The cube has all samples; those of the tile are filled up
// (fill_up()). One lane is one sample, and its operations come in one order, without fused multiply-add: results are
// the same for every SIMD level, whatever the other samples are. Thread-safe.
using PolynomialKernel = void (*)(const Coefficients& polynomial, std::size_t degree, const Cube& cube,
                                  const SampleTile& samples, Tile& values);

// That of the level, of the best one where the level is not available.
[[nodiscard]] PolynomialKernel polynomial_kernel(SimdLevel level);

}  // namespace raycone
