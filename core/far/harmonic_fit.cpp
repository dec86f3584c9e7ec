#include "core/far/harmonic_fit.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

namespace raycone {
namespace {

constexpr double kScale = 1.5;  // of coordinates, so that harmonics of all degrees are of like size on the cube

constexpr std::size_t kHalf = (kTerms + 1) / 2;  // terms of one parity along an axis

// A polynomial that is even or odd along each axis, by its Chebyshev coefficients: that of T_i(x) T_j(y) T_k(z) is at
// [k / 2][j / 2][i / 2].
class Terms {
 public:
  using Parity = std::array<std::size_t, 3>;  // of i, j, k: 1 if odd

  explicit Terms(const Parity& parity) : parity_(parity) {}

  [[nodiscard]] const Parity& parity() const { return parity_; }
  double& at(std::size_t i, std::size_t j, std::size_t k) { return numbers_[(k / 2 * kHalf + j / 2) * kHalf + i / 2]; }

  // *this += factor * (x, y or z) * p, p of degree `degree`. x T_n = (T_{n+1} + T_{|n-1|}) / 2.
  void add_times_coordinate(double factor, int axis, Terms& p, std::size_t degree) {
    p.for_each(degree, [&](std::array<std::size_t, 3> place, double value) {
      std::size_t& n = place[static_cast<std::size_t>(axis)];
      const std::size_t below = n > 0 ? n - 1 : 1;
      ++n;
      add(place, factor / 2 * value);
      n = below;
      add(place, factor / 2 * value);
    });
  }

  // *this += factor * (x^2 + y^2 + z^2) * p. x^2 T_n = (T_{n+2} + 2 T_n + T_{|n-2|}) / 4.
  void add_times_square(double factor, Terms& p, std::size_t degree) {
    p.for_each(degree, [&](const std::array<std::size_t, 3>& place, double value) {
      const double quarter = factor / 4 * value;
      add(place, 6 * quarter);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        std::array<std::size_t, 3> other = place;
        other[axis] = place[axis] + 2;
        add(other, quarter);
        other[axis] = place[axis] >= 2 ? place[axis] - 2 : 2 - place[axis];
        add(other, quarter);
      }
    });
  }

 private:
  void add(const std::array<std::size_t, 3>& place, double value) { at(place[0], place[1], place[2]) += value; }

  // visit({i, j, k}, coefficient)
  template <class Visit>
  void for_each(std::size_t degree, const Visit& visit) {
    for (std::size_t k = parity_[2]; k <= degree; k += 2) {
      for (std::size_t j = parity_[1]; j + k <= degree; j += 2) {
        for (std::size_t i = parity_[0]; i + j + k <= degree; i += 2) visit({i, j, k}, at(i, j, k));
      }
    }
  }

  Parity parity_;
  std::vector<double> numbers_ = std::vector<double>(kHalf * kHalf * kHalf);
};

// A harmonic polynomial: its values at the nodes of an octant, and its coefficients.
struct Harmonic {
  std::vector<double> values;
  Terms terms;
};

// The solid harmonics R_m = Re or Im (x + i y)^m, and (n + 1 - m) R_{n+1} = (2 n + 1) z R_n - (n + m) r^2 R_{n-1}.
class SolidHarmonics {
 public:
  explicit SolidHarmonics(std::span<const Vec3> nodes) : nodes_(nodes.begin(), nodes.end()) {
    for (Vec3& q : nodes_) q = (1 / kScale) * q;
  }

  // visit(n, R_n) for the real or imaginary parts of even m, up to kDegree.
  template <class Visit>
  void for_each(bool imaginary_parts, const Visit& visit) const {
    Harmonic real = constant(1.0, {0, 0, 0}), imaginary = constant(0.0, {0, 1, 0});
    for (std::size_t m = 0; m <= kDegree; ++m) {
      if (m > 0) {
        Harmonic next = combination(m - 1, {1, 0, real}, {-1, 1, imaginary});
        imaginary = combination(m - 1, {1, 1, real}, {1, 0, imaginary});
        real = std::move(next);
      }
      if (m % 2 == 0 && !(imaginary_parts && m == 0)) ascend(m, imaginary_parts ? imaginary : real, visit);
    }
  }

 private:
  struct Part {
    double factor;
    int axis;
    Harmonic& of;
  };

  [[nodiscard]] Harmonic constant(double value, const Terms::Parity& parity) const {
    Harmonic h{std::vector<double>(nodes_.size(), value), Terms(parity)};
    h.terms.at(0, 0, 0) = value;
    return h;
  }

  [[nodiscard]] Harmonic combination(std::size_t degree, const Part& a, const Part& b) const {
    Terms::Parity parity = a.of.terms.parity();
    parity[static_cast<std::size_t>(a.axis)] ^= 1U;
    Harmonic h{std::vector<double>(nodes_.size()), Terms(parity)};
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
    Terms::Parity parity = first.terms.parity();
    Harmonic here = first;
    parity[2] ^= 1U;
    Harmonic before = constant(0.0, parity);
    for (std::size_t n = m; n <= kDegree; ++n) {
      visit(n, here);
      if (n == kDegree) return;
      const double divisor = static_cast<double>(n + 1 - m);
      const double up = static_cast<double>(2 * n + 1) / divisor, down = -static_cast<double>(n + m) / divisor;
      Harmonic next{std::vector<double>(nodes_.size()), Terms(before.terms.parity())};
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

struct Term {
  std::size_t i, j, k;
  [[nodiscard]] std::size_t degree() const { return i + j + k; }
};

// All of a parity, low degrees first.
std::vector<Term> terms_of(const Terms::Parity& parity) {
  std::vector<Term> terms;
  for (std::size_t k = parity[2]; k < kTerms; k += 2) {
    for (std::size_t j = parity[1]; j + k < kTerms; j += 2) {
      for (std::size_t i = parity[0]; i + j + k < kTerms; i += 2) terms.push_back({i, j, k});
    }
  }
  std::ranges::stable_sort(terms, {}, &Term::degree);
  return terms;
}

// A function with its values at the nodes of an octant and its coefficients.
struct BasisRow {
  std::size_t degree;
  std::vector<double> values, coefficients;
};

double product(const std::vector<double>& a, const std::vector<double>& b) {
  std::array<double, 4> sums{};  // which need not wait for one another
  static_assert(HarmonicFit::kNodes / 8 % sums.size() == 0);
  for (std::size_t i = 0; i < a.size(); i += sums.size()) {
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += a[i + k] * b[i + k];
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

void add_multiple(double factor, const std::vector<double>& other, std::vector<double>& sum) {
  for (std::size_t i = 0; i < other.size(); ++i) sum[i] += factor * other[i];
}

// Makes the rows orthonormal at the nodes: by the modified method of Gram and Schmidt, twice, which is as good as any.
// The coefficients follow at last. Those of low degrees are few.
void make_orthonormal(std::vector<BasisRow>& rows) {
  std::vector<double> shares;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    BasisRow& row = rows[n];
    shares.assign(n, 0.0);
    for (int pass = 0; pass < 2; ++pass) {
      for (std::size_t other = 0; other < n; ++other) {
        const double share = product(row.values, rows[other].values);
        add_multiple(-share, rows[other].values, row.values);
        shares[other] += share;
      }
    }
    for (std::size_t other = 0; other < n; ++other) {
      add_multiple(-shares[other], rows[other].coefficients, row.coefficients);
    }
    const double inverse = 1 / std::sqrt(product(row.values, row.values));
    for (double& number : row.values) number *= inverse;
    for (double& number : row.coefficients) number *= inverse;
  }
}

// Of the harmonics of both parities along z that `imaginary` parts have, by this parity; low degrees first.
std::array<std::vector<BasisRow>, 2> bases_of(bool imaginary, std::span<const Vec3> octant,
                                              const std::array<std::vector<Term>, 2>& terms) {
  std::array<std::vector<BasisRow>, 2> bases;
  SolidHarmonics(octant).for_each(imaginary, [&](std::size_t degree, Harmonic& h) {
    const std::size_t odd = h.terms.parity()[2];
    BasisRow& row = bases[odd].emplace_back(BasisRow{degree, h.values, {}});
    for (const Term& t : terms[odd]) {
      if (t.degree() > degree) break;
      row.coefficients.push_back(h.terms.at(t.i, t.j, t.k));
    }
  });
  for (std::vector<BasisRow>& rows : bases) {
    std::ranges::stable_sort(rows, {}, &BasisRow::degree);
    make_orthonormal(rows);
  }
  return bases;
}

// The matrices of a basis. What is of a degree depends on no row of a lower one.
HarmonicFit::Kind kind_of(const std::vector<BasisRow>& basis, const std::vector<Term>& terms) {
  HarmonicFit::Kind kind;
  kind.rows = basis.size();
  for (const BasisRow& row : basis) {
    for (const double value : row.values) kind.to_basis.push_back(value / 8);
  }
  kind.to_terms.resize(terms.size() * basis.size());
  for (std::size_t n = 0; n < basis.size(); ++n) {
    for (std::size_t t = 0; t < basis[n].coefficients.size(); ++t) {
      kind.to_terms[t * basis.size() + n] = basis[n].coefficients[t];
    }
  }
  for (std::size_t t = 0; t < terms.size(); ++t) {
    if (t > 0 && terms[t - 1].degree() == terms[t].degree()) {
      ++kind.groups.back().terms;
    } else {
      const auto first = std::ranges::lower_bound(basis, terms[t].degree(), {}, &BasisRow::degree);
      kind.groups.push_back({static_cast<std::size_t>(first - basis.begin()), 1});
    }
  }
  return kind;
}

}  // namespace

// Exchanging two axes makes each of the eight parities one of these: none odd, z, x and y, all.
HarmonicFit::HarmonicFit() {
  set_nodes();
  std::array<std::vector<Term>, 4> terms;  // of kinds, which have as many odd axes
  for (const std::size_t imaginary : {0U, 1U}) {
    const std::size_t even = 2 * imaginary, odd = even + 1;
    terms[even] = terms_of({imaginary, imaginary, 0});
    terms[odd] = terms_of({imaginary, imaginary, 1});
    const auto bases = bases_of(imaginary == 1, std::span(nodes_).first(kOctant), {terms[even], terms[odd]});
    kinds_[even] = kind_of(bases[0], terms[even]);
    kinds_[odd] = kind_of(bases[1], terms[odd]);
  }
  for (std::size_t parity = 0; parity < 8; ++parity) {
    ParityClass& c = classes_[parity];
    c.kind = static_cast<std::size_t>(std::popcount(parity));
    constexpr std::array<std::size_t, 8> kExchanged{2, 2, 1, 0, 0, 1, 2, 2};  // with z: the axis unlike both others
    const std::size_t axis = kExchanged[parity];
    for (const Term& t : terms[c.kind]) {
      std::array<std::size_t, 3> place{t.i, t.j, t.k};
      std::swap(place[axis], place[2]);
      c.places.push_back(kRows.begin(place[1], place[2]) + place[0]);
    }
    const std::span octant = std::span(nodes_).first(kOctant);
    for (Vec3 node : octant) {
      std::swap(node[static_cast<int>(axis)], node.z);
      c.nodes.push_back(static_cast<std::size_t>(std::ranges::find(octant, node) - octant.begin()));
    }
  }
}

const HarmonicFit& HarmonicFit::instance() {
  static const HarmonicFit fit;
  return fit;
}

void HarmonicFit::set_nodes() {
  std::vector<double> along;
  for (std::size_t n = 1; n <= kNodesAlong / 2; ++n) {
    // With a significand of 64 bits: cosines of doubles are not the same with every C library.
    const long double angle = static_cast<long double>(2 * n - 1) * std::numbers::pi_v<long double> / (2 * kNodesAlong);
    along.push_back(static_cast<double>(std::cos(angle)));
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
  std::vector<double> at_nodes(kNumbers), basis, coefficients;
  for (std::size_t parity = 0; parity < 8; ++parity) {
    const ParityClass& c = classes_[parity];
    const Kind& kind = kinds_[c.kind];
    for (std::size_t n = 0; n < kOctant; ++n) {
      std::copy_n(&mixed[parity * kNumbers + c.nodes[n] * kTogether], kTogether, &at_nodes[n * kTogether]);
    }
    basis.resize(kind.rows * kTogether);
    kernel.multiply({kind.to_basis.data(), kOctant, 1}, {at_nodes.data(), kTogether}, {basis.data(), kTogether},
                    kind.rows, kOctant, kTogether);
    coefficients.resize(c.places.size() * kTogether);
    std::size_t term = 0;
    for (const auto& [first_row, terms] : kind.groups) {
      kernel.multiply({&kind.to_terms[term * kind.rows + first_row], kind.rows, 1},
                      {&basis[first_row * kTogether], kTogether}, {&coefficients[term * kTogether], kTogether}, terms,
                      kind.rows - first_row, kTogether);
      term += terms;
    }
    for (term = 0; term < c.places.size(); ++term) {
      for (std::size_t f = 0; f < polynomials.size(); ++f) {
        polynomials[f][c.places[term]] = coefficients[term * kTogether + f];
      }
    }
  }
}

}  // namespace raycone
