#include "core/far/multipole.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <numeric>

#include "core/far/gauss_rule.h"

namespace raycone {
namespace {

constexpr std::size_t index(int i) { return static_cast<std::size_t>(i); }

using Complex = std::complex<double>;
constexpr int kP = kMultipoleOrder;
static_assert(kMomentOrder == kP - 1);
static_assert(GaussRule::kMost == (kP + 1) / 2);
constexpr double kUnitRoundoff = 0x1p-53;
constexpr double kUp = 1 + 1e-12;  // more than what rounds in a sum of positive numbers here
constexpr double kFourPi = 4 * std::numbers::pi;

// Constants of the bounds.
struct Tables {
  std::array<double, 2 * kP + 1> factorial{};
  std::array<double, kP + 1> double_factorial{};   // (2n - 1)!!
  std::array<double, kMultipoleTerms> regular{};   // what |R_n^m| is at most, all terms of its recurrence positive
  std::array<double, kMultipoleTerms> legendre{};  // likewise |b_n^m| at r = 1
  std::array<double, kP + 1> moment{};             // the norm of the moments of an edge with |a||b - a| = 1
  // [points][n]: what is left out of them by a rule of Gauss's of so few points, on an edge of length 1
  std::array<std::array<double, kP + 1>, GaussRule::kMost + 1> left_out{};
  std::array<double, kP + 1> shift{};                       // the norm of `regular`
  std::array<std::array<double, kP + 1>, kP + 1> choose{};  // sqrt of (2n over 2k)

  Tables();
  void set_harmonics();
  void set_norms();
  void set_left_out();
  [[nodiscard]] double weight(int n, int m) const { return factorial[index(n + m)] * factorial[index(n - m)]; }
};

Tables::Tables() {
  factorial[0] = 1;
  for (std::size_t i = 1; i < factorial.size(); ++i) factorial[i] = factorial[i - 1] * static_cast<double>(i);
  double_factorial[0] = 1;
  for (std::size_t n = 1; n < double_factorial.size(); ++n)
    double_factorial[n] = double_factorial[n - 1] * static_cast<double>(2 * n - 1);
  set_harmonics();
  set_norms();
  set_left_out();
}

void Tables::set_harmonics() {
  for (int m = 0; m <= kP; ++m) {
    double corner = 1, b = 1, b_before = 0;
    for (int i = 1; i <= m; ++i) corner /= 2 * i;
    double r = corner, r_before = 0;
    for (int n = m; n <= kP; ++n) {
      regular[multipole_index(n, m)] = r;
      legendre[multipole_index(n, m)] = b;
      const double next = ((2 * n + 1) * r + r_before) / ((n + 1) * (n + 1) - m * m);
      r_before = r;
      r = next;
      const double b_next = b + multipole_step(n, m) * b_before;
      b_before = b;
      b = b_next;
    }
  }
}

void Tables::set_norms() {
  const auto regular_at = [&](int n, int m) { return m > n ? 0.0 : regular[multipole_index(n, std::abs(m))]; };
  for (int n = 0; n <= kP; ++n) {
    const auto i = index(n);
    double of_moment = 0, of_shift = 0;
    for (int m = -n; m <= n; ++m) {
      const int k = std::abs(m);
      of_shift += weight(n, k) * regular_at(n, k) * regular_at(n, k);
      if (n == 0) continue;
      const double sum = regular_at(n - 1, k) + regular_at(n - 1, k + 1) + regular_at(n - 1, std::abs(k - 1));
      of_moment += weight(n, k) * sum * sum;
    }
    moment[i] = kUp * std::sqrt(of_moment) / (kFourPi * (n + 1));
    shift[i] = kUp * std::sqrt(of_shift);
    double c = 1;
    for (int k = 0; k <= n; ++k) {
      choose[i][index(k)] = kUp * std::sqrt(c);
      c = c * ((2 * n - 2 * k) * (2 * n - 2 * k - 1)) / ((2 * k + 1) * (2 * k + 2));
    }
  }
}

// Gauss's rule of G points leaves out (G!)^4 / ((2G + 1) (2G)!^3) times a derivative of order 2G.
void Tables::set_left_out() {
  for (int points = 1; points <= static_cast<int>(GaussRule::kMost); ++points) {
    const double ratio = factorial[index(points)] / factorial[index(2 * points)] * factorial[index(points)];
    for (int n = 2 * points + 1; n <= kP; ++n) {
      left_out[index(points)][index(n)] =
          kUp * ratio * ratio * choose[index(n)][index(2 * points + 1)] / (kFourPi * (n + 1));
    }
  }
}

const Tables& tables() {
  static const Tables all;
  return all;
}

// The sums of (a x b) times the integral of R_n^m along an edge a -> b, n < order.
class EdgeSums {
 public:
  EdgeSums(int order, const GaussRule& rule, const MomentKernel& kernel) : kernel_(kernel), order_(order), rule_(rule) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::fill_n(lanes_.re[axis].begin(), terms(), MomentLanes{});
      std::fill_n(lanes_.im[axis].begin(), terms(), MomentLanes{});
    }
  }

  void add(const Vec3& a, const Vec3& along, double sign) {
    const Vec3 normal = sign * cross(a, along);
    for (int axis = 0; axis < 3; ++axis) {
      const auto i = index(axis);
      edges_.from[i][count_] = a[axis];
      edges_.along[i][count_] = along[axis];
      edges_.normal[i][count_] = normal[axis];
    }
    if (++count_ < kMomentLanes) return;
    kernel_.add_edges(edges_, order_, rule_, lanes_);
    count_ = 0;
  }
  void finish() {
    while (count_ > 0) add({}, {}, 0.0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t term = 0; term < terms(); ++term) {
        const MomentLanes &re = lanes_.re[axis][term], &im = lanes_.im[axis][term];
        sums_[axis][term] = {std::accumulate(re.begin(), re.end(), 0.0), std::accumulate(im.begin(), im.end(), 0.0)};
      }
    }
  }
  // Of component `axis` of a x b, any m.
  [[nodiscard]] Complex operator()(std::size_t axis, int n, int m) const {
    if (std::abs(m) > n) return 0.0;
    const Complex c = sums_[axis][multipole_index(n, std::abs(m), order_ - 1)];
    return m >= 0 ? c : m % 2 == 0 ? std::conj(c) : -std::conj(c);
  }

 private:
  [[nodiscard]] std::size_t terms() const { return multipole_index(order_ - 1, order_ - 1, order_ - 1) + 1; }

  MomentKernel kernel_;
  int order_;
  const GaussRule& rule_;
  MomentEdges edges_;
  std::size_t count_ = 0;
  MomentSums lanes_;
  std::array<std::array<Complex, kMomentTerms>, 3> sums_;
};

// R_n^m(s), m >= 0, n < order.
std::array<Complex, kMultipoleTerms> regular_harmonics(const Vec3& s, int order) {
  std::array<Complex, kMultipoleTerms> all;
  const double square = dot(s, s);
  Complex corner = 1.0;
  for (int m = 0; m < order; ++m) {
    Complex value = corner, before = 0.0;
    for (int n = m; n < order; ++n) {
      all[multipole_index(n, m)] = value;
      const double step = 1.0 / ((n + 1) * (n + 1) - m * m);
      const Complex next = (2 * n + 1) * step * s.z * value - step * square * before;
      before = value;
      value = next;
    }
    corner *= Complex(s.x, s.y) * (-1.0 / (2 * (m + 1)));
  }
  return all;
}

// at(n, m) for all m >= 0, and what follows for the others.
template <class At>
DegreeRows rows_of(int order, const At& at) {
  DegreeRows rows;
  for (int n = 0; n <= order; ++n) {
    for (int m = 0; m <= n; ++m) {
      const Complex c = at(n, m), mirrored = m % 2 == 0 ? std::conj(c) : -std::conj(c);
      const std::size_t to = index(DegreeRows::kMiddle + m), back = index(DegreeRows::kMiddle - m);
      rows.re[index(n)][back] = mirrored.real();
      rows.im[index(n)][back] = mirrored.imag();
      rows.re[index(n)][to] = c.real();
      rows.im[index(n)][to] = c.imag();
    }
  }
  return rows;
}

// What rules of few points leave out of the moments of edges that are not longer than `longest`.
class LeftOut {
 public:
  LeftOut(double longest, double radius) {  // products: std::pow differs between processors
    squares_[0] = radii_[0] = 1;
    for (std::size_t i = 1; i < squares_.size(); ++i) squares_[i] = squares_[i - 1] * longest * longest;
    for (std::size_t i = 1; i < radii_.size(); ++i) radii_[i] = radii_[i - 1] * radius;
  }

  // Of those of degree n, per |a||b - a|.
  [[nodiscard]] double of_moments(std::size_t points, int n) const {
    const int derivative = 2 * static_cast<int>(points);
    if (n <= derivative) return 0;
    return kUp * tables().left_out[points][index(n)] * squares_[points] * radii_[index(n - derivative - 1)];
  }

  // The fewest that leave out no more than `precision` of what any moment may be, seen from two units away.
  [[nodiscard]] std::size_t points_for(int order, double precision) const {
    const std::size_t exact = static_cast<std::size_t>(order - 1) / 2 + 1;
    for (std::size_t points = 1; points < exact; ++points) {
      double largest = 0;
      for (int n = 1; n <= order; ++n) largest = std::max(largest, std::ldexp(of_moments(points, n), -(n + 1)));
      if (largest <= precision / kFourPi) return points;
    }
    return exact;
  }

 private:
  std::array<double, GaussRule::kMost + 1> squares_;  // powers of that of the length
  std::array<double, kP + 1> radii_;                  // powers
};

double longest_side_of(std::span<const SolidTriangle> triangles) {
  double longest = 0;
  for (const SolidTriangle& t : triangles) {
    longest = std::max({longest, norm(t.b - t.a), norm(t.c - t.b), norm(t.a - t.c)});
  }
  return longest;
}

}  // namespace

Multipole multipole_of(std::span<const SolidTriangle> triangles, const MultipoleBall& ball, int order, double precision,
                       const MomentKernel& kernel) {
  const auto& [centre, unit, radius] = ball;
  const double scale = 1 / unit, longest = kUp * scale * longest_side_of(triangles);
  const LeftOut left_out(longest, radius);
  const std::size_t points = left_out.points_for(order, precision);
  EdgeSums sums(order, gauss_rule(points), kernel);
  double reach = 0;  // the sum of |a||b - a|
  for (const SolidTriangle& t : triangles) {
    const std::array<Vec3, 3> corners{scale * (t.a - centre), scale * (t.b - centre), scale * (t.c - centre)};
    const std::array<Vec3, 3> sides{scale * (t.b - t.a), scale * (t.c - t.b), scale * (t.a - t.c)};
    for (std::size_t i = 0; i < 3; ++i) {
      sums.add(corners[i], sides[i], t.orientation);
      reach += norm(corners[i]) * norm(sides[i]);
    }
  }
  sums.finish();
  Multipole all{order, {}, {}, {}};
  double power = 1;  // of the radius
  for (int n = 1; n <= order; ++n) {
    for (int m = 0; m <= n; ++m) {
      const Complex gradient = sums(2, n - 1, m) + 0.5 * (sums(0, n - 1, m + 1) - sums(0, n - 1, m - 1)) -
                               Complex(0, 0.5) * (sums(1, n - 1, m + 1) + sums(1, n - 1, m - 1));
      const double factor = -1 / (kFourPi * (n + 1));
      all.re[multipole_index(n, m)] = factor * gradient.real();
      all.im[multipole_index(n, m)] = -factor * gradient.imag();
    }
    const auto i = index(n);
    const double roundings = 2 * (20.0 * (n - 1) + 45 + 3 * static_cast<double>(triangles.size()));
    all.error[i] =
        kUp * reach * (roundings * kUnitRoundoff * power * tables().moment[i] + left_out.of_moments(points, n));
    power *= radius;
  }
  return all;
}

void add_shifted(Multipole& sum, const Multipole& part, const Vec3& shift, double ratio, const MomentKernel& kernel) {
  const int order = sum.order;
  const std::array<Complex, kMultipoleTerms> harmonics = regular_harmonics(shift, order);
  const auto regular = rows_of(order - 1, [&](int n, int m) { return std::conj(harmonics[multipole_index(n, m)]); });
  std::array<double, kP + 1> powers{};  // of the ratio, the exponent being n + 1
  powers[0] = ratio;
  for (std::size_t n = 1; n <= kP; ++n) powers[n] = powers[n - 1] * ratio;
  const auto moments = rows_of(order, [&](int n, int m) {
    const std::size_t term = multipole_index(n, m);
    return powers[index(n)] * Complex(part.re[term], part.im[term]);
  });
  DegreeRows shifted;
  kernel.shift(regular, moments, order, shifted);
  for (int n = 1; n <= order; ++n) {
    for (int m = 0; m <= n; ++m) {
      sum.re[multipole_index(n, m)] += shifted.re[index(n)][index(DegreeRows::kMiddle + m)];
      sum.im[multipole_index(n, m)] += shifted.im[index(n)][index(DegreeRows::kMiddle + m)];
    }
  }
  const MultipoleBounds bounds = bounds_of(part);
  const double length = norm(shift);
  for (int n = 1; n <= order; ++n) {
    double error = 0, power = 1;  // of the length
    for (int k = 0; k < n; ++k) {
      const auto i = index(n), j = index(n - k), l = index(k);
      const double roundings = 2 * kUnitRoundoff * (10 * k + 20 + n * n) * tables().shift[l];
      error += power * tables().choose[i][l] * powers[j] * (part.error[j] + roundings * bounds.size[j]);
      power *= length;
    }
    sum.error[index(n)] += kUp * error;
  }
}

MultipoleBounds bounds_of(const Multipole& multipole) {
  MultipoleBounds bounds;
  bounds.order = multipole.order;
  const Tables& t = tables();
  for (int n = 1; n <= multipole.order; ++n) {
    const auto i = index(n);
    double square = 0, terms = 0;
    for (int m = 0; m <= n; ++m) {
      const std::size_t term = multipole_index(n, m);
      const double twice = m == 0 ? 1 : 2;
      const double norm = multipole.re[term] * multipole.re[term] + multipole.im[term] * multipole.im[term];
      square += twice * norm * t.weight(n, m);
      terms += twice * std::sqrt(norm) * t.double_factorial[i] * t.legendre[term];
    }
    bounds.size[i] = kUp * std::sqrt(square) + multipole.error[i];
    bounds.evaluation[i] = kUp * 2 * kUnitRoundoff * (9 * n + 40) * terms + multipole.error[i];
  }
  return bounds;
}

// |grad of r^n P_n| <= n r^(n-1) (Bernstein and Szego), summed over n.
double beyond_multipoles(double area, double radius, int order, double rho) {
  const double x = radius * rho;
  if (!(x < 1)) return std::numeric_limits<double>::infinity();
  double power = rho * rho;
  for (int i = 0; i < order; ++i) power *= x;
  return kUp * area / kFourPi * power * (order + 1 - order * x) / ((1 - x) * (1 - x));
}

void set_coefficients(const Multipole& multipole, int order, std::span<double> coefficients) {
  for (int m = 0; m <= order; ++m) {
    for (int n = std::max(m, 1); n <= order; ++n) {
      const double factor = tables().double_factorial[index(n)] * (m == 0 ? 1 : 2) * (m % 2 == 0 ? 1 : -1);
      const std::size_t from = multipole_index(n, m), to = coefficient_index(n, m);
      coefficients[2 * to] = factor * multipole.re[from];
      coefficients[2 * to + 1] = factor * multipole.im[from];
    }
  }
  coefficients[0] = coefficients[1] = 0.0;
}

}  // namespace raycone
