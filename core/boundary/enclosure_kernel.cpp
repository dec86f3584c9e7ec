// Every constant counts roundings, derived in docs/method.md, "Error bound".
#include "core/boundary/enclosure_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/boundary/edge_factor.h"
#include "core/boundary/near_edge.h"
#include "core/exact/double_double.h"
#include "core/exact/quad.h"

// Highway compiles what is between its markers once per SIMD level.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/boundary/enclosure_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/boundary/level_edges-inl.h"
#include "core/exact/double_double_lanes-inl.h"
#include "core/machine/simd_kernel.h"

#ifndef RAYCONE_CORE_ENCLOSURE_KERNEL_CPP_
#define RAYCONE_CORE_ENCLOSURE_KERNEL_CPP_
namespace raycone {
namespace {

constexpr double kRounding = 0x1p-100;  // what an operation of DoubleDouble is off by at most, relative
// A part that is 0, or less than this, counts as this much: sums of DoubleDouble do not keep the sign of 0, which tells
// half a turn from minus half a turn. Where it is so small beside the other part, it adds less than kNoPart in the end.
constexpr double kTiny = 0x1p-1000;

// A factor, and a bound of its argument's error in radians.
struct PairFactor {
  DoubleDouble re, im;
  double error;
};

DoubleDouble rounded_pair(Quad x) {
  const auto high = static_cast<double>(x);
  return {high, static_cast<double>(x - high)};
}

// The same argument but for 2^-998, the larger part in [1, 2).
PairFactor normalized(const NearEdgeFactor<Quad>& close) {
  constexpr double kLargest = 0x1p1000;
  const DoubleDouble re = rounded_pair(close.factor.re), im = rounded_pair(close.factor.im);
  const double largest = std::max(std::abs(re.high), std::abs(im.high));
  if (!(largest > 1 / kLargest && largest < kLargest)) return {{1}, {kTiny}, std::numeric_limits<double>::infinity()};
  const double scale = std::scalbn(1.0, -std::ilogb(largest));
  const auto part = [&](const DoubleDouble& x) {
    const double high = scale * x.high;
    return std::abs(high) > kTiny ? DoubleDouble{high, scale * x.low} : DoubleDouble{std::copysign(kTiny, high)};
  };
  return {part(re), part(im), static_cast<double>(close.error) + kRounding};
}

}  // namespace
}  // namespace raycone
#endif

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

using Pair = DoubleDoubleLanes;

// One step of Newton's method doubles the digits.
HWY_INLINE Pair square_root(const Pair& x) {
  const Lanes guess = hn::Sqrt(x.high);
  const Pair rest = x - exact_product(guess, guess);
  return exact_sum_of_ordered(guess, hn::Div(rest.high, hn::Add(guess, guess)));
}

HWY_INLINE Lanes taxicab(const Pair& a, const Pair& b) { return hn::Add(hn::Abs(a.high), hn::Abs(b.high)); }

HWY_INLINE Pair times(const Pair& a, Lanes exact_factor) {
  return {hn::Mul(a.high, exact_factor), hn::Mul(a.low, exact_factor)};
}

HWY_INLINE Pair choice(LaneMask where, const Pair& yes, const Pair& no) {
  return {hn::IfThenElse(where, yes.high, no.high), hn::IfThenElse(where, yes.low, no.low)};
}

struct QueryLanes {
  Lanes x, y, z;
};

// A vertex as seen from the queries.
struct VertexLanes {
  Pair y, z, s;
  LaneMask in_range;  // nothing that matters over- or underflows in a factor
};

HWY_INLINE VertexLanes seen(const Vec3& v, const QueryLanes& q) {
  const Pair x = exact_sum(hn::Set(d, v.x), hn::Neg(q.x));
  const Pair y = exact_sum(hn::Set(d, v.y), hn::Neg(q.y)), z = exact_sum(hn::Set(d, v.z), hn::Neg(q.z));
  const Pair square = y * y + z * z;
  const auto ahead = hn::Gt(x.high, hn::Zero(d));
  const Pair sum = square_root(x * x + square) + choice(ahead, x, {hn::Neg(x.high), hn::Neg(x.low)});
  const auto in_range =
      hn::And(hn::And(hn::Gt(square.high, hn::Set(d, 0x1p-200)), hn::Lt(square.high, hn::Set(d, 0x1p200))),
              hn::Lt(hn::Abs(x.high), hn::Set(d, 0x1p100)));
  return {y, z, choice(ahead, square / sum, sum), in_range};
}

struct FactorLanes {
  Pair re, im;
  Lanes error;
};

HWY_INLINE FactorLanes choice(LaneMask where, const FactorLanes& yes, const FactorLanes& no) {
  return {choice(where, yes.re, no.re), choice(where, yes.im, no.im), hn::IfThenElse(where, yes.error, no.error)};
}

// The factor by its plain formula, and where it is trusted: it is well conditioned and in range, and the sign of its
// imaginary part is sure.
HWY_INLINE FactorLanes plain_factor(const VertexLanes& a, const VertexLanes& b, LaneMask& trusted) {
  const Lanes most_condition = hn::Set(d, 64.0), least = hn::Set(d, 0x1p-500);
  const Pair product_of_s = a.s * b.s, y = a.y * b.y, z = a.z * b.z, left = a.y * b.z, right = a.z * b.y;
  const Pair re = product_of_s + (y + z), im = left - right;
  const Lanes of_im = taxicab(left, right);
  const Lanes condition = hn::Div(hn::Add(hn::Add(product_of_s.high, taxicab(y, z)), of_im), taxicab(re, im));
  const Lanes doubt = hn::Max(hn::Mul(hn::Set(d, 4 * kRounding), of_im), least);
  trusted = hn::And(hn::And(a.in_range, b.in_range),
                    hn::And(hn::Lt(condition, most_condition), hn::Gt(hn::Abs(im.high), doubt)));
  return {re, im, hn::Mul(hn::Set(d, 40 * kRounding), condition)};
}

// A factor with the argument 0.
HWY_INLINE FactorLanes no_factor() {
  return {{hn::Set(d, 1.0), hn::Zero(d)}, {hn::Set(d, kTiny), hn::Zero(d)}, hn::Zero(d)};
}

// Replaces those that are not trusted.
HWY_NOINLINE FactorLanes with_careful_lanes(const FactorLanes& plain, LaneMask trusted, const Vec3& from,
                                            const ChainStep& step, const SampleTile& samples, std::size_t i) {
  alignas(64) std::array<double, kMostLanes> re_high, re_low, im_high, im_low, error;
  hn::Store(plain.re.high, d, re_high.data());
  hn::Store(plain.re.low, d, re_low.data());
  hn::Store(plain.im.high, d, im_high.data());
  hn::Store(plain.im.low, d, im_low.data());
  hn::Store(plain.error, d, error.data());
  const std::uint32_t bits = bits_of(trusted);
  for (std::size_t lane = 0; lane < std::min(hn::Lanes(d), samples.count - i); ++lane) {
    if ((bits >> lane) & 1U) continue;
    const auto close = close_edge_factor(from, step, samples.query(i + lane));
    const PairFactor f = close ? normalized(*close) : PairFactor{{1}, {kTiny}, 0};
    re_high[lane] = f.re.high;
    re_low[lane] = f.re.low;
    im_high[lane] = f.im.high;
    im_low[lane] = f.im.low;
    error[lane] = f.error;
  }
  return {{hn::Load(d, re_high.data()), hn::Load(d, re_low.data())},
          {hn::Load(d, im_high.data()), hn::Load(d, im_low.data())},
          hn::Load(d, error.data())};
}

struct PairProductLanes {
  Pair re, im;
  Lanes turns, error;
};

// 2^-k for the largest part, which is in [2^k, 2^(k+1)).
HWY_INLINE Lanes inverse_of_exponent(const Pair& re, const Pair& im) {
  const hn::RebindToUnsigned<Doubles> bits;
  const auto largest = hn::BitCast(bits, hn::Max(hn::Abs(re.high), hn::Abs(im.high)));
  const auto exponent = hn::And(largest, hn::Set(bits, 0x7FF0000000000000U));
  return hn::BitCast(d, hn::Sub(hn::Set(bits, std::uint64_t{2046} << 52), exponent));
}

HWY_INLINE Pair not_tiny(const Pair& x) {
  const Lanes tiny = hn::Set(d, kTiny);
  return choice(hn::Gt(hn::Abs(x.high), tiny), x, {hn::CopySign(tiny, x.high), hn::Zero(d)});
}

HWY_INLINE PairProductLanes times(const PairProductLanes& z, const FactorLanes& f) {
  const Pair re = z.re * f.re - z.im * f.im, im = z.re * f.im + z.im * f.re;
  const Lanes scale = inverse_of_exponent(re, im);
  const Lanes before = z.im.high, turn = f.im.high, after = im.high;
  const Lanes passes = hn::AndNot(hn::Xor(before, turn), hn::Xor(before, after));  // its sign bit
  const Lanes turns = hn::IfNegativeThenElse(passes, hn::CopySignToAbs(hn::Set(d, 1.0), before), hn::Zero(d));
  const Lanes error = hn::Add(hn::Add(z.error, f.error), hn::Set(d, 4 * kRounding));
  return {not_tiny(times(re, scale)), not_tiny(times(im, scale)), hn::Add(z.turns, turns), error};
}

// At the samples from i on.
HWY_INLINE PairProductLanes product_of_all(std::span<const ChainStep> steps, const SampleTile& samples, std::size_t i) {
  const QueryLanes q{hn::Load(d, &samples.x[i]), hn::Load(d, &samples.y[i]), hn::Load(d, &samples.z[i])};
  const Lanes zero = hn::Zero(d);
  PairProductLanes product{{hn::Set(d, 1.0), zero}, {hn::Set(d, kTiny), zero}, zero, zero};
  VertexLanes from = seen(steps.front().to, q);
  for (std::size_t n = 1; n < steps.size(); ++n) {
    const VertexLanes to = seen(steps[n].to, q);
    if (steps[n].joined) {
      LaneMask trusted;
      FactorLanes f = plain_factor(from, to, trusted);
      if (steps[n].reversed) f.im = {hn::Neg(f.im.high), hn::Neg(f.im.low)};
      if (HWY_UNLIKELY(!hn::AllTrue(d, trusted))) {
        const auto none = is_level_beside(from.y.high, from.z.high, to.y.high, to.z.high);
        f = with_careful_lanes(choice(none, no_factor(), f), hn::Or(trusted, none), steps[n - 1].to, steps[n], samples,
                               i);
      }
      product = times(product, f);
    }
    from = to;
  }
  return product;
}

void multiply_pairs_here(std::span<const ChainStep> steps, const SampleTile& samples, PairProductTile& products) {
  for (std::size_t i = 0; i < samples.count; i += hn::Lanes(d)) {
    const PairProductLanes product = product_of_all(steps, samples, i);
    hn::Store(product.re.high, d, &products.re_high[i]);
    hn::Store(product.re.low, d, &products.re_low[i]);
    hn::Store(product.im.high, d, &products.im_high[i]);
    hn::Store(product.im.low, d, &products.im_low[i]);
    hn::Store(product.turns, d, &products.turns[i]);
    hn::Store(product.error, d, &products.error[i]);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raycone {

EnclosureKernel enclosure_kernel(SimdLevel level) { return RAYCONE_AT_LEVEL(level, multiply_pairs_here); }

}  // namespace raycone
#endif
