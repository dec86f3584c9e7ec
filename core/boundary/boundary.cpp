// On which side of a critical value of a rule a winding number is. The cone determines w but for an integer, which the
// value at hand, close to w, tells.
#include <quadmath.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/boundary/cone.h"
#include "core/boundary/near_edge.h"
#include "core/boundary/tied_factor.h"
#include "core/data/rule.h"
#include "core/exact/predicates.h"

namespace raycone {
namespace {

const Quad kTurn = 8 * atanq(1);
constexpr Quad u = 0x1p-113;

Quad absolute(Quad x) { return x < 0 ? -x : x; }

// A product of factors in 113 bits, and the turns that its argument has completed, as in core/boundary/enclosure.cpp.
struct CloseProduct {
  Factor<Quad> z{1, 0};
  std::int64_t turns = 0;
  Quad error = 0;  // of its argument, radians

  // `error`: of the factor's argument. Both factors and product are rounded, the latter by sqrt(5) u (docs/method.md).
  void multiply(const Factor<Quad>& f, Quad factor_error) {
    const Factor<Quad> product{z.re * f.re - z.im * f.im, z.re * f.im + z.im * f.re};
    const bool before = signbitq(z.im) != 0, turn = signbitq(f.im) != 0, after = signbitq(product.im) != 0;
    if (before == turn && after != before) turns += before ? -1 : 1;
    error += factor_error + 8 * u;
    const int exponent = -ilogbq(fmaxq(absolute(product.re), absolute(product.im)));
    z = {scalbnq(product.re, exponent), scalbnq(product.im, exponent)};
  }
};

void multiply_edge(CloseProduct& product, const Vec3& a, const Vec3& b, bool reversed, const Vec3& q) {
  const EdgeSide side = edge_side(a, b, q);
  if (side.sign == 0) return;
  const auto with_sign = [&](const Factor<Quad>& f) {
    return Factor<Quad>{f.re, copysignq(f.im, reversed ? -side.sign : side.sign)};
  };
  if (side.tie) {
    if (const auto f = unscaled_tied_factor<Quad>(a, b, q)) product.multiply(with_sign(*f), 0);
    return;
  }
  const NearEdgeFactor<Quad> f = near_edge_factor<Quad>(a, b, q);
  product.multiply(with_sign(f.factor), f.error);
}

// Whether w, which differs from `value` by less than 1/8 and from -(turns of the cone) by an integer, is above
// `critical` (1), below (-1), or cannot be told from it (0). `rounding`: u of Real.
template <class Real>
int side_of(double critical, double value, const TurnsWithin<Real>& cone, Real rounding) {
  const auto rest = static_cast<long double>(cone.rest);
  const auto n = static_cast<std::int64_t>(std::nearbyint(value + (static_cast<long double>(cone.whole) + rest)));
  const Real whole = static_cast<Real>(n - cone.whole);
  const Real w = whole - cone.rest;
  const Real difference = w - static_cast<Real>(critical);
  const auto magnitude = [](Real x) { return x < 0 ? -x : x; };
  const Real bound = cone.bound + 2 * rounding * (magnitude(w) + magnitude(difference));
  const Real error = bound > Real(kIndistinguishable) ? bound : Real(kIndistinguishable);
  return static_cast<int>(difference > error) - static_cast<int>(difference < -error);
}

bool on_segment(const Vec3& a, const Vec3& b, const Vec3& q) { return on_triangle(a, b, b, q); }

}  // namespace

TurnsWithin<Quad> Cone::enclose_closely(const Vec3& q) const {
  TurnsWithin<Quad> cone;
  for (const Group& group : groups_) {
    CloseProduct product;
    for (std::size_t i = 1; i < group.steps.size(); ++i) {
      const ChainStep& step = group.steps[i];
      if (step.joined) multiply_edge(product, group.steps[i - 1].to, step.to, step.reversed, q);
    }
    const Quad rest = group.multiplicity * (atan2q(product.z.im, product.z.re) / kTurn);
    cone.whole += group.multiplicity * product.turns;
    cone.rest += rest;
    cone.bound += group.multiplicity * (product.error / kTurn) + 8 * u * (absolute(rest) + absolute(cone.rest));
  }
  return cone;
}

// The plane through all exterior edges, if there is one and no more.
void Cone::find_plane() {
  const Vec3 *a = nullptr, *b = nullptr, *c = nullptr;
  for (const Group& group : groups_) {
    for (const ChainStep& step : group.steps) {
      const Vec3& v = step.to;
      if (!a) {
        a = &v;
      } else if (!b) {
        if (v != *a) b = &v;
      } else if (!c) {
        if (!collinear(*a, *b, v)) c = &v;
      } else if (plane_side(*a, *b, *c, v) != 0) {
        return;
      }
    }
  }
  if (c) plane_ = {*a, *b, *c};
}

// In the plane of all exterior edges the cone over them with its apex in that plane is flat: it covers nothing, or half
// of all directions, of a query that is on none of the edges. w is then a multiple of 1/2.
bool Cone::lies_in_plane_of_edges(const Vec3& q) const {
  if (!plane_ || plane_side((*plane_)[0], (*plane_)[1], (*plane_)[2], q) != 0) return false;
  for (const auto& [a, b] : edges_along_rays_) {
    if (on_segment(a, b, q)) return false;
  }
  for (const Group& group : groups_) {
    for (std::size_t i = 1; i < group.steps.size(); ++i) {
      const ChainStep& step = group.steps[i];
      if (step.joined && on_segment(group.steps[i - 1].to, step.to, q)) return false;
    }
  }
  return true;
}

double Cone::settle(const Vec3& q, double w, double critical) const {
  const bool multiple_of_half = std::nearbyint(2 * critical) == 2 * critical;
  if (multiple_of_half && std::abs(w - critical) < 0.25 && lies_in_plane_of_edges(q)) return critical;
  int side = side_of<long double>(critical, w, enclose(q), std::numeric_limits<long double>::epsilon() / 2);
  if (side == 0) side = side_of<Quad>(critical, w, enclose_closely(q), u);
  if (side == 0) return critical;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return side > 0 ? std::max(w, std::nextafter(critical, kInfinity))
                  : std::min(w, std::nextafter(critical, -kInfinity));
}

}  // namespace raycone
