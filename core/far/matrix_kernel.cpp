#include "core/far/matrix_kernel.h"

#include <algorithm>
#include <cstddef>
#include <span>

// Highway compiles what is between its markers once per SIMD level.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/far/matrix_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/machine/lanes-inl.h"
#include "core/machine/simd_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

constexpr std::size_t kWidth = 8;  // numbers of a row that are summed together

// Four rows, in accumulators that stay in registers.
HWY_INLINE void four_rows(const MatrixView& a, const double* b, std::size_t b_row, double* out, std::size_t out_row,
                          std::size_t depth) {
  Lanes s0 = hn::Zero(d), s1 = s0, s2 = s0, s3 = s0;
  const double* p = a.numbers;
  for (std::size_t k = 0; k < depth; ++k, p += a.step, b += b_row) {
    const Lanes v = hn::LoadU(d, b);
    s0 = hn::Add(s0, hn::Mul(hn::Set(d, p[0]), v));
    s1 = hn::Add(s1, hn::Mul(hn::Set(d, p[a.row]), v));
    s2 = hn::Add(s2, hn::Mul(hn::Set(d, p[2 * a.row]), v));
    s3 = hn::Add(s3, hn::Mul(hn::Set(d, p[3 * a.row]), v));
  }
  hn::StoreU(s0, d, out);
  hn::StoreU(s1, d, out + out_row);
  hn::StoreU(s2, d, out + 2 * out_row);
  hn::StoreU(s3, d, out + 3 * out_row);
}

HWY_INLINE void one_row(const MatrixView& a, const double* b, std::size_t b_row, double* out, std::size_t depth) {
  Lanes sum = hn::Zero(d);
  const double* p = a.numbers;
  for (std::size_t k = 0; k < depth; ++k, p += a.step, b += b_row) {
    sum = hn::Add(sum, hn::Mul(hn::Set(d, *p), hn::LoadU(d, b)));
  }
  hn::StoreU(sum, d, out);
}

void multiply_here(const MatrixView& a, const RowsView<const double>& b, const RowsView<double>& out, std::size_t rows,
                   std::size_t depth, std::size_t width) {
  for (std::size_t w = 0; w < width; w += kWidth) {
    for (std::size_t lane = w; lane < w + kWidth; lane += hn::Lanes(d)) {
      std::size_t r = 0;
      for (; r + 4 <= rows; r += 4) {
        four_rows({a.numbers + r * a.row, a.row, a.step}, b.numbers + lane, b.row, out.numbers + r * out.row + lane,
                  out.row, depth);
      }
      for (; r < rows; ++r) {
        one_row({a.numbers + r * a.row, a.row, a.step}, b.numbers + lane, b.row, out.numbers + r * out.row + lane,
                depth);
      }
    }
  }
}

// Four rows up to the least of their depths, then each by itself.
HWY_INLINE void four_ragged_rows(const RaggedRow* rows, const double* b, std::size_t b_row, std::size_t lane) {
  const std::size_t depth = std::min({rows[0].depth, rows[1].depth, rows[2].depth, rows[3].depth});
  Lanes s0 = hn::Zero(d), s1 = s0, s2 = s0, s3 = s0;
  for (std::size_t k = 0; k < depth; ++k) {
    const Lanes v = hn::LoadU(d, b + k * b_row);
    s0 = hn::Add(s0, hn::Mul(hn::Set(d, rows[0].numbers[k]), v));
    s1 = hn::Add(s1, hn::Mul(hn::Set(d, rows[1].numbers[k]), v));
    s2 = hn::Add(s2, hn::Mul(hn::Set(d, rows[2].numbers[k]), v));
    s3 = hn::Add(s3, hn::Mul(hn::Set(d, rows[3].numbers[k]), v));
  }
  const auto finish = [&](const RaggedRow& row, Lanes sum) {
    for (std::size_t k = depth; k < row.depth; ++k) {
      sum = hn::Add(sum, hn::Mul(hn::Set(d, row.numbers[k]), hn::LoadU(d, b + k * b_row)));
    }
    hn::StoreU(sum, d, row.out + lane);
  };
  finish(rows[0], s0);
  finish(rows[1], s1);
  finish(rows[2], s2);
  finish(rows[3], s3);
}

void multiply_ragged_here(std::span<const RaggedRow> rows, const RowsView<const double>& b, std::size_t width) {
  for (std::size_t lane = 0; lane < width; lane += hn::Lanes(d)) {
    std::size_t r = 0;
    for (; r + 4 <= rows.size(); r += 4) four_ragged_rows(&rows[r], b.numbers + lane, b.row, lane);
    for (; r < rows.size(); ++r) {
      one_row({rows[r].numbers, 0, 1}, b.numbers + lane, b.row, rows[r].out + lane, rows[r].depth);
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raycone {

MatrixKernel matrix_kernel(SimdLevel level) {
  return {RAYCONE_AT_LEVEL(level, multiply_here), RAYCONE_AT_LEVEL(level, multiply_ragged_here)};
}

}  // namespace raycone
#endif
