// The term of an exterior edge with D = 0: the line through the query along the ray meets the edge's line.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/boundary/near_edge.h"
#include "core/exact/predicates.h"

namespace raycone {

// Re and |Im| of a number with the argument of z_ab(q), where D = 0 and the edge does not project to a point
// (docs/method.md, "Exact zeros"), of any magnitude, each rounded once; the sign of Im is that of edge_side(). Nothing
// where the argument is 0.
template <class Wide>  // long double or Quad, for their exponents: nothing here over- or underflows
[[nodiscard]] std::optional<Factor<Wide>> unscaled_tied_factor(const Vec3& a, const Vec3& b, const Vec3& q) {
  const Wide ay = Wide(a.y) - Wide(q.y), az = Wide(a.z) - Wide(q.z);
  const Wide by = Wide(b.y) - Wide(q.y), bz = Wide(b.z) - Wide(q.z);
  const auto factor = [](Wide re, Wide im) { return Factor<Wide>{re, im < 0 ? -im : im}; };
  // The ray passes through an end ahead, (s, P) = (0, -1); if q lies at it or beyond, the argument is 0.
  if (ay == 0 && az == 0) return a.x > q.x ? std::optional(factor(-by, bz)) : std::nullopt;
  if (by == 0 && bz == 0) return b.x > q.x ? std::optional(factor(-ay, az)) : std::nullopt;
  // P_a and P_b lie on one line through 0: the signs of one coordinate tell whether on opposite sides.
  const bool opposite = ay != 0 ? (ay < 0) != (by < 0) : (az < 0) != (bz < 0);
  if (!opposite || meeting_side(a, b, q) <= 0) return std::nullopt;
  return factor(-1, 0);
}

// The same with max(|re|, |im|) in [1, 2], each rounded once to Real (and to 64 bits before).
template <class Real>  // double or long double
[[nodiscard]] std::optional<Factor<Real>> tied_factor(const Vec3& a, const Vec3& b, const Vec3& q) {
  const std::optional<Factor<long double>> f = unscaled_tied_factor<long double>(a, b, q);
  if (!f) return std::nullopt;
  const int exponent = -std::ilogb(std::max(std::abs(f->re), f->im));
  return Factor<Real>{static_cast<Real>(std::scalbn(f->re, exponent)), static_cast<Real>(std::scalbn(f->im, exponent))};
}

}  // namespace raycone
