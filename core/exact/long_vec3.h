// Vectors with 64 bits of mantissa, so that differences keep what doubles can store, and with exponents of 15 bits,
// which no product of a few doubles leaves.
#pragma once

#include <cmath>

#include "core/data/vec3.h"
#include "core/data/vec3_of.h"

namespace raycone {

using LongVec3 = Vec3Of<long double>;

inline LongVec3 long_difference(const Vec3& a, const Vec3& b) {
  using Long = long double;
  return {Long{a.x} - Long{b.x}, Long{a.y} - Long{b.y}, Long{a.z} - Long{b.z}};
}

inline long double norm(const LongVec3& v) { return std::sqrt(dot(v, v)); }

// A triangle's normal, twice its area long.
inline LongVec3 long_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  return cross(long_difference(b, a), long_difference(c, a));
}

}  // namespace raycone
