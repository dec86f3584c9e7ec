// The term of an exterior edge with D = 0: the line through the query along the ray meets the edge's line.
#pragma once

#include <optional>

#include "core/near_edge.h"
#include "core/predicates.h"

namespace raycone {

// Re and |Im| of a number with the argument of z_ab(q), where D = 0 and the edge does not project to a point (METHOD
// section 3, rule 4): each rounded once; the sign of Im is that of edge_side(). Nothing where the argument is 0.
template <class Real>
[[nodiscard]] std::optional<Factor<Real>> tied_factor(const Vec3& a, const Vec3& b, const Vec3& q) {
  const Real ay = Real(a.y) - Real(q.y), az = Real(a.z) - Real(q.z);
  const Real by = Real(b.y) - Real(q.y), bz = Real(b.z) - Real(q.z);
  // The ray passes through an end ahead, (s, P) = (0, -1); if q lies at it or beyond, the argument is 0.
  if (ay == 0 && az == 0) {
    if (!(a.x > q.x)) return std::nullopt;
    return Factor<Real>{-by, std::abs(bz)};
  }
  if (by == 0 && bz == 0) {
    if (!(b.x > q.x)) return std::nullopt;
    return Factor<Real>{-ay, std::abs(az)};
  }
  // P_a and P_b lie on one line through 0: the signs of one coordinate tell whether on opposite sides.
  const bool opposite = ay != 0 ? (ay < 0) != (by < 0) : (az < 0) != (bz < 0);
  if (!opposite || meeting_side(a, b, q) <= 0) return std::nullopt;
  return Factor<Real>{-1, 0};
}

}  // namespace raycone
