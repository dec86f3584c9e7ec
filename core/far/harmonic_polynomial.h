// Polynomials on a cube, as sums of products of Chebyshev polynomials in x, y and z.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/data/vec3.h"
#include "core/far/matrix_kernel.h"
#include "core/machine/simd.h"

namespace raycone {

// The points c with |c - centre| <= half along each axis.
struct Cube {
  Vec3 centre;
  double half;
};

inline constexpr std::size_t kDegree = 22;  // total degree
inline constexpr std::size_t kTerms = kDegree + 1;

// Where the coefficient of T_i(x) T_j(y) T_k(z) is, i + j + k <= kDegree: the row of j and k, then i. Rows are filled
// up with zeros to multiples of 8.
class CoefficientRows {
 public:
  constexpr CoefficientRows() : begin_{}, size_(0) {
    for (std::size_t k = 0; k < kTerms; ++k) {
      for (std::size_t j = 0; j + k < kTerms; ++j) {
        begin_[k][j] = size_;
        size_ += padded_to_lanes(kTerms - j - k);
      }
    }
  }
  [[nodiscard]] constexpr std::size_t begin(std::size_t j, std::size_t k) const { return begin_[k][j]; }
  [[nodiscard]] constexpr std::size_t size() const { return size_; }

 private:
  std::array<std::array<std::size_t, kTerms>, kTerms> begin_;
  std::size_t size_;
};
inline constexpr CoefficientRows kRows;

// Of a function on a cube; coordinates of Chebyshev polynomials are those from its centre, in half sides.
using Coefficients = std::array<double, kRows.size()>;

// The same polynomial on another cube, but for rounding. Where that is not within the first one, coefficients grow.
[[nodiscard]] Coefficients on_cube(const Coefficients& polynomial, const Cube& from, const Cube& to,
                                   const MatrixKernel& kernel);

struct Truncation {
  std::size_t degree;
  double dropped;  // sum of the magnitudes of the coefficients beyond, which no value on the cube exceeds
};

// The least degree beyond which the coefficients are within `budget` together.
[[nodiscard]] Truncation truncation(const Coefficients& polynomial, double budget);

// The values of a polynomial up to a degree at all (x, y, z) of three lists, x fastest.
class GridValues {
 public:
  explicit GridValues(const MatrixKernel& kernel) : kernel_(kernel) {}

  // Valid until the next call: row (y, z) begins at (z * ys.size() + y) * row_size(xs.size()).
  [[nodiscard]] std::span<const double> evaluate(const Coefficients& polynomial, std::size_t degree, const Cube& cube,
                                                 std::span<const double> xs, std::span<const double> ys,
                                                 std::span<const double> zs);
  [[nodiscard]] static std::size_t row_size(std::size_t samples) { return padded_to_lanes(samples); }

 private:
  MatrixKernel kernel_;
  std::vector<double> along_x_, along_y_, along_z_;  // T_i of each sample: row i
  std::vector<RaggedRow> ragged_;
  std::vector<double> rows_, layers_, values_;  // with x, then y, then z put in
};

}  // namespace raycone
