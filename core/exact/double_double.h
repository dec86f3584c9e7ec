// Numbers of about 106 bits as unevaluated sums of two doubles (Dekker 1971; Hida, Li, Bailey 2001), some twenty times
// as fast as 113-bit arithmetic. For magnitudes that neither overflow when squared nor lose what matters to underflow.
#pragma once

#include "core/data/vec3.h"
#include "core/data/vec3_of.h"

namespace raycone {

struct DoubleDouble {
  double high = 0.0;  // the number rounded
  double low = 0.0;   // and the rest
};

// a + b, exactly.
inline DoubleDouble exact_sum(double a, double b) {
  const double sum = a + b, part = sum - a;
  return {sum, (a - (sum - part)) + (b - part)};
}

// a + b, exactly, where |a| >= |b| or a = 0.
inline DoubleDouble exact_sum_of_ordered(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

// a b, exactly but for underflow.
inline DoubleDouble exact_product(double a, double b) {
  constexpr double kSplitter = 0x1p27 + 1;
  const double a_split = kSplitter * a, b_split = kSplitter * b;
  const double a_high = a_split - (a_split - a), b_high = b_split - (b_split - b);
  const double a_low = a - a_high, b_low = b - b_high;
  const double product = a * b;
  return {product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low};
}

// Sums, products and quotients are off by less than 2^-100 of themselves.
inline DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
  DoubleDouble sum = exact_sum(a.high, b.high);
  const DoubleDouble rest = exact_sum(a.low, b.low);
  sum = exact_sum_of_ordered(sum.high, sum.low + rest.high);
  return exact_sum_of_ordered(sum.high, sum.low + rest.low);
}

inline DoubleDouble operator-(const DoubleDouble& a) { return {-a.high, -a.low}; }
inline DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + -b; }

inline DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble product = exact_product(a.high, b.high);
  return exact_sum_of_ordered(product.high, product.low + (a.high * b.low + a.low * b.high));
}

inline DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
  const double quotient = a.high / b.high;
  const DoubleDouble rest = a - DoubleDouble{quotient} * b;
  return exact_sum_of_ordered(quotient, rest.high / b.high);
}

inline bool operator<(const DoubleDouble& a, const DoubleDouble& b) {
  return a.high < b.high || (a.high == b.high && a.low < b.low);
}

using DoubleDoubleVec3 = Vec3Of<DoubleDouble>;

inline Vec3 rounded(const DoubleDoubleVec3& v) { return {v.x.high, v.y.high, v.z.high}; }

// a - b, exactly.
inline DoubleDoubleVec3 exact_difference(const Vec3& a, const Vec3& b) {
  return {exact_sum(a.x, -b.x), exact_sum(a.y, -b.y), exact_sum(a.z, -b.z)};
}

}  // namespace raycone
