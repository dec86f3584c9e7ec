#include "core/far/harmonic_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace raycone {
namespace {

constexpr double kScale = 1.5;  // of coordinates, so that harmonics of all degrees are of like size on the cube

// A polynomial by its Chebyshev coefficients, [k][j][i] for z, y, x.
class Terms {
 public:
  double& at(std::size_t i, std::size_t j, std::size_t k) { return numbers_[(k * kTerms + j) * kTerms + i]; }
  [[nodiscard]] double at(std::size_t i, std::size_t j, std::size_t k) const {
    return numbers_[(k * kTerms + j) * kTerms + i];
  }

  // *this += factor * (x, y or z) * p, p of degree `degree`. x T_n = (T_{n+1} + T_{|n-1|}) / 2.
  void add_times_coordinate(double factor, int axis, const Terms& p, std::size_t degree) {
    const std::size_t step = axis == 0 ? 1 : axis == 1 ? kTerms : kTerms * kTerms;
    for_each(degree, [&](std::size_t i, std::size_t j, std::size_t k, std::size_t place) {
      const double value = p.numbers_[place];
      if (value == 0.0) return;
      const std::size_t n = axis == 0 ? i : axis == 1 ? j : k;
      numbers_[place + step] += factor / 2 * value;
      numbers_[n > 0 ? place - step : place + step] += factor / 2 * value;
    });
  }

  template <class Visit>
  static void for_each(std::size_t degree, const Visit& visit) {
    for (std::size_t k = 0; k <= degree; ++k) {
      for (std::size_t j = 0; j + k <= degree; ++j) {
        for (std::size_t i = 0; i + j + k <= degree; ++i) visit(i, j, k, (k * kTerms + j) * kTerms + i);
      }
    }
  }

  // *this += factor * (x^2 + y^2 + z^2) * p
  void add_times_square(double factor, const Terms& p, std::size_t degree) {
    for (int axis = 0; axis < 3; ++axis) {
      Terms times;
      times.add_times_coordinate(1.0, axis, p, degree);
      add_times_coordinate(factor, axis, times, degree + 1);
    }
  }

 private:
  std::vector<double> numbers_ = std::vector<double>(kTerms * kTerms * kTerms);
};

// A harmonic polynomial: its values at the nodes of an octant, and its coefficients.
struct Harmonic {
  std::vector<double> values;
  Terms terms;
};

// visit(parity class, harmonic) for all solid harmonics up to kDegree: R_m = Re or Im (x + i y)^m, and
// (n + 1 - m) R_{n+1} = (2 n + 1) z R_n - (n + m) r^2 R_{n-1}.
class SolidHarmonics {
 public:
  explicit SolidHarmonics(std::span<const Vec3> nodes) : nodes_(nodes.begin(), nodes.end()) {
    for (Vec3& q : nodes_) q = (1 / kScale) * q;
  }

  template <class Visit>
  void for_each(const Visit& visit) const {
    Harmonic real = constant(1.0), imaginary = constant(0.0);
    for (std::size_t m = 0; m <= kDegree; ++m) {
      if (m > 0) {
        Harmonic next = combination(m - 1, {1, 0, real}, {-1, 1, imaginary});
        imaginary = combination(m - 1, {1, 1, real}, {1, 0, imaginary});
        real = std::move(next);
      }
      ascend(m, real, [&](std::size_t n, const Harmonic& h) { visit(parity(m % 2, 0, (n - m) % 2), h); });
      if (m == 0) continue;
      ascend(m, imaginary, [&](std::size_t n, const Harmonic& h) { visit(parity((m - 1) % 2, 1, (n - m) % 2), h); });
    }
  }

  static std::size_t parity(std::size_t x, std::size_t y, std::size_t z) { return 4 * x + 2 * y + z; }

 private:
  struct Part {
    double factor;
    int axis;
    const Harmonic& of;
  };

  [[nodiscard]] Harmonic constant(double value) const {
    Harmonic h{std::vector<double>(nodes_.size(), value), {}};
    h.terms.at(0, 0, 0) = value;
    return h;
  }

  [[nodiscard]] Harmonic combination(std::size_t degree, const Part& a, const Part& b) const {
    Harmonic h{std::vector<double>(nodes_.size()), {}};
    for (const Part* part : {&a, &b}) {
      for (std::size_t n = 0; n < nodes_.size(); ++n) {
        h.values[n] += part->factor * nodes_[n][part->axis] * part->of.values[n];
      }
      h.terms.add_times_coordinate(part->factor / kScale, part->axis, part->of.terms, degree);
    }
    return h;
  }

  // visit(n, R_n) from R_m on
  template <class Visit>
  void ascend(std::size_t m, const Harmonic& first, const Visit& visit) const {
    Harmonic before = constant(0.0), here = first;
    for (std::size_t n = m; n <= kDegree; ++n) {
      visit(n, here);
      if (n == kDegree) return;
      const double divisor = static_cast<double>(n + 1 - m);
      const double up = static_cast<double>(2 * n + 1) / divisor, down = -static_cast<double>(n + m) / divisor;
      Harmonic next{std::vector<double>(nodes_.size()), {}};
      for (std::size_t i = 0; i < nodes_.size(); ++i) {
        next.values[i] = up * nodes_[i].z * here.values[i] + down * dot(nodes_[i], nodes_[i]) * before.values[i];
      }
      next.terms.add_times_coordinate(up / kScale, 2, here.terms, n);
      if (n > m) next.terms.add_times_square(down / (kScale * kScale), before.terms, n - 1);
      before = std::move(here);
      here = std::move(next);
    }
  }

  std::vector<Vec3> nodes_;
};

// Functions that are orthonormal at the nodes of an octant, with their coefficients: a row each.
class OrthonormalRows {
 public:
  OrthonormalRows(std::size_t nodes, std::vector<std::size_t> places) : nodes_(nodes), places_(std::move(places)) {}

  [[nodiscard]] std::size_t size() const { return rows_.size(); }
  [[nodiscard]] const std::vector<std::size_t>& places() const { return places_; }
  [[nodiscard]] const std::vector<double>& row(std::size_t n) const { return rows_[n]; }  // values, then coefficients

  // By the modified method of Gram and Schmidt, twice, which is as good as any.
  void add(std::vector<double> row) {
    scale(row);
    for (int pass = 0; pass < 2; ++pass) {
      for (const std::vector<double>& other : rows_) {
        const double share = product(row, other);
        for (std::size_t i = 0; i < row.size(); ++i) row[i] -= share * other[i];
      }
      scale(row);
    }
    rows_.push_back(std::move(row));
  }

 private:
  [[nodiscard]] double product(const std::vector<double>& a, const std::vector<double>& b) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < nodes_; ++i) sum += a[i] * b[i];
    return sum;
  }
  void scale(std::vector<double>& row) const {
    const double inverse = 1 / std::sqrt(product(row, row));
    for (double& number : row) number *= inverse;
  }

  std::size_t nodes_;
  std::vector<std::size_t> places_;
  std::vector<std::vector<double>> rows_;
};

// All (i, j, k) of the parity.
std::vector<std::array<std::size_t, 3>> terms_of(std::size_t parity) {
  std::vector<std::array<std::size_t, 3>> terms;
  for (std::size_t k = parity & 1U; k < kTerms; k += 2) {
    for (std::size_t j = (parity >> 1U) & 1U; j + k < kTerms; j += 2) {
      for (std::size_t i = parity >> 2U; i + j + k < kTerms; i += 2) terms.push_back({i, j, k});
    }
  }
  return terms;
}

}  // namespace

const HarmonicFit& HarmonicFit::instance() {
  static const HarmonicFit fit;
  return fit;
}

namespace {

// Of each parity class a basis of the harmonics, orthonormal at the nodes of an octant.
std::vector<OrthonormalRows> bases_of(std::span<const Vec3> octant) {
  std::vector<std::vector<std::array<std::size_t, 3>>> terms;
  std::vector<OrthonormalRows> bases;
  for (std::size_t parity = 0; parity < 8; ++parity) {
    terms.push_back(terms_of(parity));
    std::vector<std::size_t> places;
    for (const auto& [i, j, k] : terms.back()) places.push_back(kRows.begin(j, k) + i);
    bases.emplace_back(octant.size(), std::move(places));
  }
  SolidHarmonics(octant).for_each([&](std::size_t parity, const Harmonic& h) {
    std::vector<double> row = h.values;
    for (const auto& [i, j, k] : terms[parity]) row.push_back(h.terms.at(i, j, k));
    bases[parity].add(std::move(row));
  });
  return bases;
}

// A row per coefficient, a column per node of an octant, of which there are eight.
std::vector<double> matrix_of(const OrthonormalRows& basis, std::size_t octant) {
  std::vector<double> matrix(basis.places().size() * octant, 0.0);
  for (std::size_t n = 0; n < basis.size(); ++n) {
    const double* const values = basis.row(n).data();
    const double* const coefficients = values + octant;
    for (std::size_t term = 0; term < basis.places().size(); ++term) {
      const double factor = coefficients[term] / 8;
      for (std::size_t i = 0; i < octant; ++i) matrix[term * octant + i] += factor * values[i];
    }
  }
  return matrix;
}

}  // namespace

HarmonicFit::HarmonicFit() {
  set_nodes();
  const std::vector<OrthonormalRows> bases = bases_of(std::span(nodes_).first(kOctant));
  for (std::size_t parity = 0; parity < 8; ++parity) {
    classes_[parity] = {bases[parity].places(), matrix_of(bases[parity], kOctant)};
  }
}

void HarmonicFit::set_nodes() {
  std::vector<double> along;
  for (std::size_t n = 1; n <= kNodesAlong / 2; ++n) {
    along.push_back(std::cos(static_cast<double>(2 * n - 1) * std::numbers::pi / (2.0 * kNodesAlong)));
  }
  std::size_t count = 0;
  for (int face = 0; face < 3; ++face) {
    for (const double u : along) {
      for (const double v : along) {
        Vec3& node = nodes_[count++];
        node[face] = 1.0;
        node[face == 0 ? 1 : 0] = u;
        node[face == 2 ? 1 : 2] = v;
      }
    }
  }
  for (std::size_t n = kOctant; n < kNodes; ++n) {
    const std::size_t mirrored = n / kOctant;
    const Vec3& p = nodes_[n % kOctant];
    nodes_[n] = {mirrored & 4U ? -p.x : p.x, mirrored & 2U ? -p.y : p.y, mirrored & 1U ? -p.z : p.z};
  }
}

void HarmonicFit::fit(std::span<const double> values, std::span<Coefficients> polynomials,
                      const MatrixKernel& kernel) const {
  std::vector<double> mixed(values.begin(), values.end());  // sums over mirror images, with the sign of each parity
  constexpr std::size_t kNumbers = kOctant * kTogether;
  for (const std::size_t step : {4U, 2U, 1U}) {
    for (std::size_t s = 0; s < 8; ++s) {
      if (s & step) continue;
      for (std::size_t n = 0; n < kNumbers; ++n) {
        double &a = mixed[s * kNumbers + n], &b = mixed[(s | step) * kNumbers + n];
        const double sum = a + b, difference = a - b;
        a = sum;
        b = difference;
      }
    }
  }
  for (Coefficients& polynomial : polynomials) polynomial.fill(0.0);
  std::vector<double> coefficients;
  for (std::size_t parity = 0; parity < 8; ++parity) {
    const ParityClass& c = classes_[parity];
    coefficients.resize(c.places.size() * kTogether);
    kernel.multiply({c.matrix.data(), kOctant, 1}, {&mixed[parity * kNumbers], kTogether},
                    {coefficients.data(), kTogether}, c.places.size(), kOctant, kTogether);
    for (std::size_t term = 0; term < c.places.size(); ++term) {
      for (std::size_t f = 0; f < polynomials.size(); ++f) {
        polynomials[f][c.places[term]] = coefficients[term * kTogether + f];
      }
    }
  }
}

}  // namespace raycone
