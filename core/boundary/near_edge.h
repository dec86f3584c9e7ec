// The term of an exterior edge whose argument double precision cannot give.
#pragma once

#include "core/data/vec3.h"

namespace raycone {

// A complex number; only its argument counts.
template <class Real>
struct Factor {
  Real re = 1;
  Real im = 0;
};

// Close to the inside of an edge s_a s_b and conj(P_a) P_b cancel. Where |Re z| + |Im z| is less than this share of s_a
// s_b, near_edge_factor() takes over (docs/method.md, "Near a boundary edge").
inline constexpr double kNearEdge = 0x1p-8;

// A number with the argument of z_ab(q) at any distance of q from the edge and for coordinates of any magnitude, within
// `error` (radians) and the rounding of its two parts to Real. max(|re|, |im|) = 1; |im| may underflow to 0, and its
// sign is to be set from edge_side(). q does not lie on the edge's closed segment, nor on its line along the ray. Slow
// (microseconds).
template <class Real>
struct NearEdgeFactor {
  Factor<Real> factor;
  Real error;
};
template <class Real>  // double or Quad
[[nodiscard]] NearEdgeFactor<Real> near_edge_factor(const Vec3& a, const Vec3& b, const Vec3& q);

}  // namespace raycone
