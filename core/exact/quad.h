// 113-bit floating point, some hundred times slower than doubles.
#pragma once

#include "core/data/vec3.h"

namespace raycone {

using Quad = __float128;
inline constexpr Quad kQuadRounding = 0x1p-113;  // of one operation, relative

struct QuadVec3 {
  Quad x, y, z;
};
inline Quad dot(const QuadVec3& a, const QuadVec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline QuadVec3 cross(const QuadVec3& a, const QuadVec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Each component rounded once.
inline QuadVec3 quad_difference(const Vec3& a, const Vec3& b) {
  return {Quad(a.x) - b.x, Quad(a.y) - b.y, Quad(a.z) - b.z};
}

inline Quad absolute(Quad x) { return x < 0 ? -x : x; }

}  // namespace raycone
