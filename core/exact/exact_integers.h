// Doubles as integers of any size (GMP): for definitions that verification rests on, for the sign of a volume, for
// places at planes and for points in which faces meet. Only the .cpp files of these include this.
#pragma once

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/data/vec3.h"
#include "core/data/vec3_of.h"

namespace raycone::exact {

using IntegerVec3 = Vec3Of<mpz_class>;

inline constexpr int kDigits = 53;  // of a double

// e such that x times 2^e is an integer.
inline int exponent_to_integer(double x) {
  int exponent = 0;
  std::frexp(x, &exponent);
  return kDigits - exponent;
}

// x times 2^exponent. Precondition: exponent >= exponent_to_integer(x).
inline mpz_class integer(double x, int exponent) {
  int own = 0;
  const double digits = std::ldexp(std::frexp(x, &own), kDigits);
  return mpz_class(digits) << static_cast<mp_bitcnt_t>(std::max(own - kDigits + exponent, 0));
}

// e, not below 0, such that all coordinates times 2^e are integers.
inline int exponent_to_integers(const Vec3& v) {
  return std::max({0, exponent_to_integer(v.x), exponent_to_integer(v.y), exponent_to_integer(v.z)});
}
inline IntegerVec3 integers(const Vec3& v, int exponent) {
  return {integer(v.x, exponent), integer(v.y, exponent), integer(v.z, exponent)};
}

using Corners = std::array<IntegerVec3, 3>;

// Corners relative to q, times 2^exponent.
struct ScaledTriangle {
  Corners corners;
  int exponent = 0;
};

inline ScaledTriangle as_integers(const std::array<Vec3, 3>& points, const Vec3& q) {
  ScaledTriangle result;
  result.exponent = exponent_to_integers(q);
  for (const Vec3& p : points) result.exponent = std::max(result.exponent, exponent_to_integers(p));
  const IntegerVec3 origin = integers(q, result.exponent);
  for (std::size_t i = 0; i < 3; ++i) result.corners[i] = integers(points[i], result.exponent) - origin;
  return result;
}

}  // namespace raycone::exact
