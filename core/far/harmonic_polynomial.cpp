#include "core/far/harmonic_polynomial.h"

#include <cmath>

namespace raycone {
namespace {

constexpr std::size_t kPadded = padded_to_lanes(kTerms);
using Matrix = std::array<std::array<double, kPadded>, kTerms>;

// Row i: T_i(shift + stretch x) as a sum of T_0(x) to T_i(x).
Matrix chebyshev_of_part(double shift, double stretch) {
  Matrix t{};
  t[0][0] = 1.0;
  t[1][0] = shift;
  t[1][1] = stretch;
  for (std::size_t i = 1; i + 1 < kTerms; ++i) {
    for (std::size_t n = 0; n <= i + 1; ++n) {
      // x T_0 = T_1; else x T_n = (T_{n-1} + T_{n+1}) / 2
      const double below = n == 0 ? 0.0 : n == 1 ? t[i][0] : t[i][n - 1] / 2;
      const double times_x = below + t[i][n + 1] / 2;
      t[i + 1][n] = 2 * (shift * t[i][n] + stretch * times_x) - t[i - 1][n];
    }
  }
  return t;
}

// Row i: T_i of each coordinate, a row of row_size() numbers.
void set_chebyshev(std::vector<double>& rows, std::size_t degree, std::span<const double> coordinates, double centre,
                   double half) {
  const std::size_t size = GridValues::row_size(coordinates.size());
  rows.assign((degree + 1) * size, 0.0);
  for (std::size_t n = 0; n < coordinates.size(); ++n) {
    const double x = (coordinates[n] - centre) / half;
    double before = x, here = 1.0;  // T_{-1} = T_1
    for (std::size_t i = 0; i <= degree; ++i) {
      rows[i * size + n] = here;
      const double next = 2 * x * here - before;
      before = here;
      here = next;
    }
  }
}

// Each row of coefficients times the matrix. Rows that are padded to the same length are multiplied together.
void set_along_x(const Coefficients& polynomial, const Matrix& matrix, Coefficients& along_x,
                 const MatrixKernel& kernel) {
  std::array<std::vector<RaggedRow>, kPadded / 8> rows;
  for (std::size_t terms = kTerms; terms > 0; --terms) {
    for (std::size_t k = 0; k + terms <= kTerms; ++k) {
      const std::size_t row = kRows.begin(kTerms - terms - k, k);
      rows[(terms - 1) / 8].push_back({&polynomial[row], terms, &along_x[row]});
    }
  }
  for (std::size_t n = 0; n < rows.size(); ++n) {
    kernel.multiply_ragged(rows[n], {matrix[0].data(), kPadded}, 8 * (n + 1));
  }
}

}  // namespace

Coefficients on_cube(const Coefficients& polynomial, const Cube& from, const Cube& to, const MatrixKernel& kernel) {
  const double stretch = to.half / from.half;
  const Vec3 shift = to.centre - from.centre;
  std::array<Matrix, 3> parts;
  for (int axis = 0; axis < 3; ++axis) {
    parts[static_cast<std::size_t>(axis)] = chebyshev_of_part(shift[axis] / from.half, stretch);
  }
  Coefficients along_x{}, along_y{}, all{};
  set_along_x(polynomial, parts[0], along_x, kernel);
  // Rows with fewer terms follow those with more, so that sums over rows need none beyond their own length.
  const auto add_row = [](double factor, const double* row, double* sum, std::size_t terms) {
    for (std::size_t i = 0; i < terms; ++i) sum[i] += factor * row[i];
  };
  for (std::size_t k = 0; k < kTerms; ++k) {
    for (std::size_t j = 0; j + k < kTerms; ++j) {
      for (std::size_t n = 0; n <= j; ++n) {
        add_row(parts[1][j][n], &along_x[kRows.begin(j, k)], &along_y[kRows.begin(n, k)], kTerms - j - k);
      }
    }
  }
  for (std::size_t k = 0; k < kTerms; ++k) {
    for (std::size_t n = 0; n <= k; ++n) {
      for (std::size_t j = 0; j + k < kTerms; ++j) {
        add_row(parts[2][k][n], &along_y[kRows.begin(j, k)], &all[kRows.begin(j, n)], kTerms - j - k);
      }
    }
  }
  return all;
}

Truncation truncation(const Coefficients& polynomial, double budget) {
  std::array<double, kTerms> sums{};  // by degree
  for (std::size_t k = 0; k < kTerms; ++k) {
    for (std::size_t j = 0; j + k < kTerms; ++j) {
      for (std::size_t i = 0; i + j + k < kTerms; ++i) {
        sums[i + j + k] += std::abs(polynomial[kRows.begin(j, k) + i]);
      }
    }
  }
  Truncation result{kDegree, 0.0};
  while (result.degree > 0 && result.dropped + sums[result.degree] <= budget) result.dropped += sums[result.degree--];
  return result;
}

std::span<const double> GridValues::evaluate(const Coefficients& polynomial, std::size_t degree, const Cube& cube,
                                             std::span<const double> xs, std::span<const double> ys,
                                             std::span<const double> zs) {
  set_chebyshev(along_x_, degree, xs, cube.centre.x, cube.half);
  set_chebyshev(along_y_, degree, ys, cube.centre.y, cube.half);
  set_chebyshev(along_z_, degree, zs, cube.centre.z, cube.half);
  const std::size_t terms = degree + 1, row = row_size(xs.size()), layer = row * ys.size();
  rows_.resize(terms * row);
  layers_.resize(terms * layer);
  values_.resize(layer * zs.size());
  for (std::size_t k = 0; k < terms; ++k) {
    ragged_.clear();
    for (std::size_t j = 0; j + k < terms; ++j) {
      ragged_.push_back({&polynomial[kRows.begin(j, k)], terms - j - k, &rows_[j * row]});
    }
    kernel_.multiply_ragged(ragged_, {along_x_.data(), row}, row);
    kernel_.multiply({along_y_.data(), 1, row_size(ys.size())}, {rows_.data(), row}, {&layers_[k * layer], row},
                     ys.size(), terms - k, row);
  }
  kernel_.multiply({along_z_.data(), 1, row_size(zs.size())}, {layers_.data(), layer}, {values_.data(), layer},
                   zs.size(), terms, layer);
  return values_;
}

}  // namespace raycone
