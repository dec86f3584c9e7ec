// Running error analysis: every constant counts roundings, derived in docs/method.md, "Rules".
#include "core/boundary/close_enclosure.h"

#include <quadmath.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/boundary/edge_factor.h"
#include "core/boundary/near_edge.h"
#include "core/boundary/sum_of_groups.h"
#include "core/exact/double_double.h"
#include "core/exact/predicates.h"

namespace raycone {
namespace {

const Quad kTurn = 8 * atanq(1);

// ---- In 106 bits
// -----------------------------------------------------------------------------------------------------

constexpr double e = 0x1p-100;  // what an operation of DoubleDouble is off by, relative

DoubleDouble double_double(Quad x) {
  const auto high = static_cast<double>(x);
  return {high, static_cast<double>(x - high)};
}
Quad quad(const DoubleDouble& x) { return Quad(x.high) + x.low; }

// One step of Newton's method doubles the digits. Of positive numbers.
DoubleDouble square_root(const DoubleDouble& x) {
  const double guess = std::sqrt(x.high);
  const DoubleDouble rest = x - exact_product(guess, guess);
  return exact_sum_of_ordered(guess, rest.high / (2 * guess));
}

double taxicab(const DoubleDouble& a, const DoubleDouble& b) { return std::abs(a.high) + std::abs(b.high); }

// A vertex as seen from the query.
struct CloseVertex {
  Vec3 vertex;
  DoubleDouble y, z, s;
  bool in_range = false;  // nothing that matters over- or underflows in a factor

  CloseVertex() = default;
  CloseVertex(const Vec3& v, const Vec3& q) : vertex(v), y(exact_sum(v.y, -q.y)), z(exact_sum(v.z, -q.z)) {
    const DoubleDouble x = exact_sum(v.x, -q.x), square = y * y + z * z;
    const DoubleDouble norm = square_root(x * x + square);
    s = x.high > 0 ? square / (norm + x) : norm - x;
    in_range = square.high > 0x1p-200 && square.high < 0x1p200 && std::abs(x.high) < 0x1p100;
  }
};

// A factor, and a bound of its argument's error in radians.
struct CloseFactor {
  DoubleDouble re, im;
  double error;
};

// The factor by its plain formula, where that is well conditioned and in range. im is not yet given its sign.
std::optional<CloseFactor> plain_factor(const CloseVertex& a, const CloseVertex& b) {
  constexpr double kMostCondition = 64;
  if (!a.in_range || !b.in_range) return std::nullopt;
  const DoubleDouble product_of_s = a.s * b.s, y = a.y * b.y, z = a.z * b.z;
  const DoubleDouble left = a.y * b.z, right = a.z * b.y;
  const DoubleDouble re = product_of_s + (y + z), im = left - right;
  const double condition = (product_of_s.high + taxicab(y, z) + taxicab(left, right)) / taxicab(re, im);
  if (!(condition < kMostCondition)) return std::nullopt;
  return CloseFactor{re, im, 40 * e * condition};
}

std::optional<CloseFactor> factor_of(const CloseVertex& a, const CloseVertex& b, bool reversed, const Vec3& q) {
  const EdgeSide side = edge_side(a.vertex, b.vertex, q);
  if (side.sign == 0) return std::nullopt;
  const auto with_sign = [&](CloseFactor f) {
    if (std::signbit(f.im.high) != ((reversed ? -side.sign : side.sign) < 0)) f.im = -f.im;
    return f;
  };
  if (side.tie) {
    const std::optional<Factor<Quad>> f = unscaled_tied_factor<Quad>(a.vertex, b.vertex, q);
    if (!f) return std::nullopt;
    return with_sign({double_double(f->re), double_double(f->im), e});
  }
  if (const std::optional<CloseFactor> plain = plain_factor(a, b)) return with_sign(*plain);
  const NearEdgeFactor<Quad> near = near_edge_factor<Quad>(a.vertex, b.vertex, q);
  return with_sign({double_double(near.factor.re), double_double(near.factor.im), static_cast<double>(near.error) + e});
}

// The same argument but for 2^-298, the larger part in [1, 2), and none that is 0: sums of DoubleDouble do not keep the
// sign of 0, which tells half a turn from minus half a turn. The error is infinite where the factor is out of range.
CloseFactor normalized(const CloseFactor& f) {
  constexpr double kTiny = 0x1p-300, kLargest = 0x1p1000;
  const double largest = std::max(std::abs(f.re.high), std::abs(f.im.high));
  if (!(largest > 1 / kLargest && largest < kLargest)) return {{1}, {kTiny}, std::numeric_limits<double>::infinity()};
  const double scale = std::scalbn(1.0, -std::ilogb(largest));
  const auto part = [&](const DoubleDouble& x) {
    const double high = scale * x.high;
    return std::abs(high) > kTiny ? DoubleDouble{high, scale * x.low} : DoubleDouble{std::copysign(kTiny, high)};
  };
  return {part(f.re), part(f.im), f.error};
}

// The product of factors, the turns completed, and a bound of its argument's error in radians.
struct CloseProduct {
  CloseFactor z{{1}, {}, 0};
  std::int64_t turns = 0;

  void multiply(const CloseFactor& factor) {
    const CloseFactor f = normalized(factor);
    const CloseFactor product =
        normalized({z.re * f.re - z.im * f.im, z.re * f.im + z.im * f.re, z.error + f.error + 4 * e});
    const bool before = std::signbit(z.im.high), turn = std::signbit(f.im.high), after = std::signbit(product.im.high);
    if (before == turn && after != before) turns += before ? -1 : 1;
    z = product;
  }
};

TurnsWithin<Quad> turns_of(const Factor<Quad>& z, std::int64_t turns, Quad error) {
  return {turns, atan2q(z.im, z.re) / kTurn, error / kTurn};
}

TurnsWithin<Quad> enclose_in_106(const ChainGroup& group, const Vec3& q) {
  CloseProduct product;
  CloseVertex previous;
  for (const ChainStep& step : group.steps) {
    const CloseVertex here(step.to, q);
    if (step.joined) {
      if (const auto f = factor_of(previous, here, step.reversed, q)) product.multiply(*f);
    }
    previous = here;
  }
  return turns_of({quad(product.z.re), quad(product.z.im)}, product.turns, product.z.error);
}

// ---- In 113 bits
// -----------------------------------------------------------------------------------------------------

// As CloseProduct.
struct QuadProduct {
  Factor<Quad> z{1, 0};
  std::int64_t turns = 0;
  Quad error = 0;  // of its argument, radians

  // `error`: of the factor's argument. Both factors and product are rounded, the latter by sqrt(5) u (docs/method.md).
  void multiply(const Factor<Quad>& f, Quad factor_error) {
    const Factor<Quad> product{z.re * f.re - z.im * f.im, z.re * f.im + z.im * f.re};
    const bool before = signbitq(z.im) != 0, turn = signbitq(f.im) != 0, after = signbitq(product.im) != 0;
    if (before == turn && after != before) turns += before ? -1 : 1;
    error += factor_error + 8 * kQuadRounding;
    const int exponent = -ilogbq(fmaxq(absolute(product.re), absolute(product.im)));
    z = {scalbnq(product.re, exponent), scalbnq(product.im, exponent)};
  }
};

void multiply_edge(QuadProduct& product, const Vec3& a, const Vec3& b, bool reversed, const Vec3& q) {
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

TurnsWithin<Quad> enclose_in_113(const ChainGroup& group, const Vec3& q) {
  QuadProduct product;
  for (std::size_t i = 1; i < group.steps.size(); ++i) {
    const ChainStep& step = group.steps[i];
    if (step.joined) multiply_edge(product, group.steps[i - 1].to, step.to, step.reversed, q);
  }
  return turns_of(product.z, product.turns, product.error);
}

}  // namespace

TurnsWithin<Quad> enclose_in_106_bits(std::span<const ChainGroup> groups, const Vec3& q) {
  return sum_of_groups<Quad>(groups, 8 * kQuadRounding,
                             [&](const ChainGroup& group) { return enclose_in_106(group, q); });
}

TurnsWithin<Quad> enclose_in_113_bits(std::span<const ChainGroup> groups, const Vec3& q) {
  return sum_of_groups<Quad>(groups, 8 * kQuadRounding,
                             [&](const ChainGroup& group) { return enclose_in_113(group, q); });
}

}  // namespace raycone
