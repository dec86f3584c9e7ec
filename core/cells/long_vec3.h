// Vectors with 64 bits of mantissa, so that differences keep what doubles can store.
#pragma once

#include "core/data/vec3.h"

namespace raycone {

struct LongVec3 {
  long double x = 0, y = 0, z = 0;
};

inline LongVec3 long_difference(const Vec3& a, const Vec3& b) {
  using Long = long double;
  return {Long{a.x} - Long{b.x}, Long{a.y} - Long{b.y}, Long{a.z} - Long{b.z}};
}

inline LongVec3 long_cross(const LongVec3& a, const LongVec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

inline long double long_dot(const LongVec3& a, const LongVec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// Of a triangle; twice its area long.
inline LongVec3 long_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  return long_cross(long_difference(b, a), long_difference(c, a));
}

}  // namespace raycone
