// 113-bit floating point, some hundred times slower than doubles.
#pragma once

namespace raycone {

using Quad = __float128;

struct QuadVec3 {
  Quad x, y, z;
};

inline Quad absolute(Quad x) { return x < 0 ? -x : x; }

}  // namespace raycone
