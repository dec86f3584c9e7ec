// Determinants of differences of doubles, rounded to within a unit in the last place, in 113-bit arithmetic with exact
// products and sums. Some hundred times slower than in doubles; rounded to double, some ten times.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "core/data/vec3.h"
#include "core/exact/double_double.h"
#include "core/exact/quad.h"

namespace raycone {

// A difference of two doubles, exactly, as the two terms of a sum: nothing is rounded, nothing overflows.
struct Difference {
  double plus;
  double minus;
  [[nodiscard]] Quad rounded() const { return Quad(plus) + minus; }
};

inline Difference difference(double x, double y) { return {x, -y}; }

// The exact sum of the terms added, as a non-overlapping expansion (Shewchuk 1997, grow-expansion).
class ExactSum {
 public:
  void add(Quad term) {
    for (std::size_t i = 0; i < size_; ++i) {
      const Quad sum = term + terms_[i];
      const Quad part = sum - term;
      terms_[i] = (term - (sum - part)) + (terms_[i] - part);
      term = sum;
    }
    terms_[size_++] = term;
  }
  [[nodiscard]] Quad rounded() const {
    Quad sum = 0;
    for (std::size_t i = 0; i < size_; ++i) sum += terms_[i];  // from the smallest
    return sum;
  }

 private:
  std::array<Quad, 8> terms_{};
  std::size_t size_ = 0;
};

inline void add_product(ExactSum& sum, const Difference& x, const Difference& y, int sign) {
  for (const double a : {x.plus, x.minus}) {
    for (const double b : {y.plus, y.minus}) sum.add(Quad(sign) * a * b);  // 106 bits: exact
  }
}

// a d - b c of exact differences, rounded to within a unit in the last place.
[[nodiscard]] inline Quad determinant(const Difference& a, const Difference& b, const Difference& c,
                                      const Difference& d) {
  ExactSum sum;
  add_product(sum, a, d, 1);
  add_product(sum, b, c, -1);
  return sum.rounded();
}

// (a - q) x (b - q), each component as exact.
[[nodiscard]] inline QuadVec3 cross_of_differences(const Vec3& a, const Vec3& b, const Vec3& q) {
  const Difference ax = difference(a.x, q.x), ay = difference(a.y, q.y), az = difference(a.z, q.z);
  const Difference bx = difference(b.x, q.x), by = difference(b.y, q.y), bz = difference(b.z, q.z);
  return {determinant(ay, az, by, bz), determinant(az, ax, bz, bx), determinant(ax, ay, bx, by)};
}

// determinant(), then rounded to double; never -0. 106 bits are enough unless the determinant lies next to the middle
// between two doubles, nearly cancels, or comes near to underflow (NaN and infinity fail the tests, too). It is surely
// 0 where the differences are doubles and their products, which are exact then, are the same.
[[nodiscard]] inline double rounded_determinant(const Difference& a, const Difference& b, const Difference& c,
                                                const Difference& d) {
  const auto exactly = [](const Difference& x) { return exact_sum(x.plus, x.minus); };
  const DoubleDouble of_a = exactly(a), of_b = exactly(b), of_c = exactly(c), of_d = exactly(d);
  const DoubleDouble ad = of_a * of_d, bc = of_b * of_c, sum = ad - bc;
  const double terms = std::abs(ad.high) + std::abs(bc.high);
  const double error = 0x1p-97 * terms;  // eight times what is lost at most
  constexpr double kLeast = 0x1p-850;    // nothing that matters underflows
  const bool is_sure = sum.high + (sum.low + error) == sum.high && sum.high + (sum.low - error) == sum.high;
  const bool has_no_terms = (of_a.high == 0.0 || of_d.high == 0.0) && (of_b.high == 0.0 || of_c.high == 0.0);
  const bool is_zero = of_a.low == 0.0 && of_b.low == 0.0 && of_c.low == 0.0 && of_d.low == 0.0 && ad.high == bc.high &&
                       ad.low == bc.low;
  const bool in_range = terms > kLeast || has_no_terms;
  return ((is_sure || is_zero) && in_range ? sum.high : static_cast<double>(determinant(a, b, c, d))) + 0.0;
}

// (a - q) x (b - q), each component as rounded_determinant().
[[nodiscard]] inline Vec3 rounded_cross_of_differences(const Vec3& a, const Vec3& b, const Vec3& q) {
  const auto component = [&](int i, int j) {
    return rounded_determinant(difference(a[i], q[i]), difference(a[j], q[j]), difference(b[i], q[i]),
                               difference(b[j], q[j]));
  };
  return {component(1, 2), component(2, 0), component(0, 1)};
}

}  // namespace raycone
