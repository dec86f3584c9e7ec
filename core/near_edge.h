// The term of an exterior edge whose argument double precision cannot give.
#pragma once

#include "core/vec3.h"

namespace raycone {

// A complex number; only its argument counts.
struct Factor {
  double re = 1.0;
  double im = 0.0;
};

// A number with the argument of z_ab(q), to a few units in the last place at any distance of q from the edge and for
// coordinates of any magnitude, max(|re|, |im|) = 1; |im| may underflow to 0, and its sign is to be set from
// edge_side(). q does not lie on the edge's closed segment, nor on its line along the ray. Slow (microseconds): METHOD
// section 3, rule 5.
[[nodiscard]] Factor near_edge_factor(const Vec3& a, const Vec3& b, const Vec3& q);

}  // namespace raycone
