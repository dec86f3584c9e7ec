// Running error analysis: every constant counts roundings, derived in docs/method.md, "Error bound". Exponents of long
// double neither over- nor underflow here: products of two numbers in range reach 2^+-4000, and their squares 2^+-8000.
#include "core/boundary/enclosure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "core/boundary/angle.h"
#include "core/boundary/edge_factor.h"
#include "core/boundary/near_edge.h"
#include "core/boundary/sum_of_groups.h"
#include "core/exact/predicates.h"

namespace raycone {
namespace {

using Wide = long double;

constexpr Wide u = std::numeric_limits<Wide>::epsilon() / 2;  // half a unit in the last place of 1L
// Second-order terms of the analysis: relative errors before the last step stay below 2^-48, and sums of 2^33 bounds
// round by less than 2^-31.
constexpr Wide kSecondOrder = 1 + 0x1p-30L;

// A vertex as seen from the query.
struct WideVertex {
  Vec3 vertex;
  Wide y = 0;
  Wide z = 0;
  Wide s = 0;
  Wide s_roundings = 0;

  WideVertex() = default;
  WideVertex(const Vec3& v, const Vec3& q) : vertex(v), y(Wide(v.y) - Wide(q.y)), z(Wide(v.z) - Wide(q.z)) {
    const Wide x = Wide(v.x) - Wide(q.x);
    const Wide square = y * y + z * z;
    const Wide norm = std::sqrt(x * x + square);
    s = x > 0 ? square / (norm + x) : norm - x;
    s_roundings = x > 0 ? 9.5L : 4.5L;
  }
};

// A factor and a bound of its argument's error in radians.
struct WideFactor {
  Factor<Wide> z;
  Wide error;
};

// How far arg z is off if Re and Im are off by e_re and e_im.
Wide argument_error(Wide re, Wide im, Wide e_re, Wide e_im) {
  return (std::abs(re) * e_im + std::abs(im) * e_re) / (re * re + im * im);
}

// im carries the sign that the edge's side has.
WideFactor generic_factor(const WideVertex& a, const WideVertex& b, const Vec3& q, int sign) {
  const bool a_is_nearer = std::abs(a.y) + std::abs(a.z) <= std::abs(b.y) + std::abs(b.z);
  const Wide left = (a_is_nearer ? a.y : b.y) * (Wide(b.vertex.z) - Wide(a.vertex.z));
  const Wide right = (a_is_nearer ? a.z : b.z) * (Wide(b.vertex.y) - Wide(a.vertex.y));
  const Wide im = std::copysign(left - right, Wide(sign));
  const Wide product_of_s = a.s * b.s, y = a.y * b.y, z = a.z * b.z;
  const Wide re = product_of_s + y + z;
  if (!(std::abs(re) + std::abs(im) > kNearEdge * product_of_s)) {
    const NearEdgeFactor<Wide> near = near_edge_factor<Wide>(a.vertex, b.vertex, q);
    return {{near.factor.re, std::copysign(near.factor.im, Wide(sign))}, near.error + 2 * u};
  }
  // Re: s_a s_b, its products with P, two sums; Im: two products of two differences, one difference.
  const Wide e_re = u * ((1 + a.s_roundings + b.s_roundings) * product_of_s + 5 * (std::abs(y) + std::abs(z)) +
                         product_of_s + std::abs(re));
  const Wide e_im = u * (3 * (std::abs(left) + std::abs(right)) + std::abs(im));
  return {{re, im}, argument_error(re, im, e_re, e_im)};
}

std::optional<WideFactor> factor_of(const WideVertex& a, const WideVertex& b, bool reversed, const Vec3& q) {
  const EdgeSide side = edge_side(a.vertex, b.vertex, q);
  if (side.sign == 0) return std::nullopt;
  const int sign = reversed ? -side.sign : side.sign;
  if (!side.tie) return generic_factor(a, b, q, sign);
  const std::optional<Factor<Wide>> f = tied_factor<Wide>(a.vertex, b.vertex, q);
  if (!f) return std::nullopt;
  return WideFactor{{f->re, std::copysign(f->im, Wide(sign))}, 2 * u};
}

// The same argument and bits, the magnitude within 2^+-2000.
Factor<Wide> in_range(const Factor<Wide>& z) {
  const Wide magnitude = std::max(std::abs(z.re), std::abs(z.im));
  if (magnitude > 0x1p-2000L && magnitude < 0x1p2000L) return z;  // nearly always, and scaling is slow
  const int exponent = -std::ilogb(magnitude);
  return {std::scalbn(z.re, exponent), std::scalbn(z.im, exponent)};
}

// The product of factors, the turns completed, and the errors of its argument so far.
struct WideProduct {
  Factor<Wide> z;
  std::int64_t turns = 0;
  Wide error = 0;  // radians

  void multiply(const WideFactor& factor) {
    const Factor<Wide> f = in_range(factor.z);
    const Wide rr = z.re * f.re, ii = z.im * f.im, ri = z.re * f.im, ir = z.im * f.re;
    const Factor<Wide> product{rr - ii, ri + ir};
    const bool before = std::signbit(z.im), turn = std::signbit(f.im), after = std::signbit(product.im);
    if (before == turn && after != before) turns += before ? -1 : 1;
    const Wide e_re = u * (std::abs(rr) + std::abs(ii) + std::abs(product.re));
    const Wide e_im = u * (std::abs(ri) + std::abs(ir) + std::abs(product.im));
    error += factor.error + argument_error(product.re, product.im, e_re, e_im);
    z = in_range(product);
  }
};

TurnsWithin<Wide> turns_of(const WideProduct& product) {
  const Wide rest = argument_in_turns<Wide>(product.z.re, product.z.im);
  const Wide of_factors = product.error * kSecondOrder / (2 * std::numbers::pi_v<Wide>);
  return {product.turns, rest, of_factors + kArgumentError * u * std::abs(rest)};
}

TurnsWithin<Wide> enclose_group(const ChainGroup& group, const Vec3& q) {
  WideProduct product;
  WideVertex previous;
  for (const ChainStep& step : group.steps) {
    const WideVertex here(step.to, q);
    if (step.joined) {
      if (const auto f = factor_of(previous, here, step.reversed, q)) product.multiply(*f);
    }
    previous = here;
  }
  return turns_of(product);
}

}  // namespace

TurnsWithin<Wide> enclose_in_64_bits(std::span<const ChainGroup> groups, const Vec3& q) {
  return sum_of_groups<Wide>(groups, u, [&](const ChainGroup& group) { return enclose_group(group, q); });
}

}  // namespace raycone
