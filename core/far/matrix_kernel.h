// The inner loop of harmonic polynomials: products of small matrices, in SIMD lanes.
#pragma once

#include <cstddef>
#include <span>

#include "core/machine/simd.h"

namespace raycone {

// Numbers of a matrix are `row` apart from one row to the next and `step` along a row.
struct MatrixView {
  const double* numbers;
  std::size_t row, step;
};

// Rows are `row` apart; the numbers of one lie side by side.
template <class Number>
struct RowsView {
  Number* numbers;
  std::size_t row;
};

// A row of a matrix whose rows differ in length, and where its product belongs.
struct RaggedRow {
  const double* numbers;
  std::size_t depth;
  double* out;
};

// Each number is summed in the order of k, without fused multiply-add: results are the same for every SIMD level.
// Outputs overlap neither of the factors. Widths are multiples of 8. Thread-safe.
struct MatrixKernel {
  // out[r][w] = sum over k < depth of a[r][k] b[k][w], for r < rows and w < width.
  void (*multiply)(const MatrixView& a, const RowsView<const double>& b, const RowsView<double>& out, std::size_t rows,
                   std::size_t depth, std::size_t width);
  // The same for each of the rows, as deep as it is. Fastest if neighbours are about as deep.
  void (*multiply_ragged)(std::span<const RaggedRow> rows, const RowsView<const double>& b, std::size_t width);
};

// That of the level, of the best one where the level is not available.
[[nodiscard]] MatrixKernel matrix_kernel(SimdLevel level);

}  // namespace raycone
