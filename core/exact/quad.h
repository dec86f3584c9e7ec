// 113-bit floating point, some hundred times slower than doubles.
#pragma once

#include "core/data/vec3.h"
#include "core/data/vec3_of.h"

namespace raycone {

using Quad = __float128;
inline constexpr Quad kQuadRounding = 0x1p-113;  // of one operation, relative

using QuadVec3 = Vec3Of<Quad>;

// Each component rounded once.
inline QuadVec3 quad_difference(const Vec3& a, const Vec3& b) {
  return {Quad(a.x) - b.x, Quad(a.y) - b.y, Quad(a.z) - b.z};
}

inline Quad absolute(Quad x) { return x < 0 ? -x : x; }

}  // namespace raycone
