// Products of complex factors in SIMD lanes, one per sample: what kernels share. Included once per SIMD level.
#if defined(RAYCONE_CORE_PRODUCT_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYCONE_CORE_PRODUCT_LANES_INL_H_
#undef RAYCONE_CORE_PRODUCT_LANES_INL_H_
#else
#define RAYCONE_CORE_PRODUCT_LANES_INL_H_
#endif

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/boundary/sample_tile.h"
#include "core/machine/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

constexpr std::size_t kFactorsPerBlock = 8;  // multiplied before anybody looks whether all went well
// Factors within these bounds can be multiplied that many times onto a number near 1.
constexpr double kSmallestFactor = 0x1p-120;
constexpr double kLargestFactor = 0x1p120;
constexpr double kLargestProduct = 0x1p1000;

// Lanes of a ProductTile while they are in registers.
struct ProductLanes {
  Lanes re, im, passages;
};

// A product times re + i im; direction is the sign of im as +-1.
HWY_INLINE ProductLanes times(const ProductLanes& z, Lanes f_re, Lanes f_im, Lanes direction) {
  const Lanes re = hn::Sub(hn::Mul(z.re, f_re), hn::Mul(z.im, f_im));
  const Lanes im = hn::Add(hn::Mul(z.re, f_im), hn::Mul(z.im, f_re));
  return {re, im, hn::Add(z.passages, hn::IfNegativeThenElse(hn::Xor(z.im, im), direction, hn::Zero(d)))};
}

// Without the power of two, which is exact.
HWY_INLINE ProductLanes scaled(const ProductLanes& z) {
  const hn::RebindToUnsigned<Doubles> bits;
  const auto largest = hn::BitCast(bits, hn::Max(hn::Abs(z.re), hn::Abs(z.im)));
  const auto exponent = hn::And(largest, hn::Set(bits, 0x7FF0000000000000U));
  const Lanes inverse = hn::BitCast(d, hn::Sub(hn::Set(bits, std::uint64_t{2046} << 52), exponent));
  return {hn::Mul(z.re, inverse), hn::Mul(z.im, inverse), z.passages};
}

HWY_INLINE ProductLanes load(const ProductTile& products, std::size_t i) {
  return {hn::Load(d, &products.re[i]), hn::Load(d, &products.im[i]), hn::Load(d, &products.passages[i])};
}

HWY_INLINE void store(const ProductLanes& z, ProductTile& products, std::size_t i) {
  hn::Store(z.re, d, &products.re[i]);
  hn::Store(z.im, d, &products.im[i]);
  hn::Store(z.passages, d, &products.passages[i]);
}

// One sample's product times re + i im.
void multiply_one(ProductTile& z, std::size_t i, double re, double im) {
  const double before = z.im[i];
  const double product_re = z.re[i] * re - before * im, product_im = z.re[i] * im + before * re;
  if (std::signbit(before) != std::signbit(product_im)) z.passages[i] += std::signbit(im) ? -1.0 : 1.0;
  z.re[i] = product_re;
  z.im[i] = product_im;
}

// A block's product, where all its factors were trusted and none so large that it shows as one that is large, infinite
// or NaN.
HWY_INLINE LaneMask is_sound(const ProductLanes& z) {
  return hn::Lt(hn::Add(hn::Abs(z.re), hn::Abs(z.im)), hn::Set(d, kLargestProduct));
}

// Stores the trusted lanes of a block's product; the others have been multiplied in memory.
HWY_INLINE void store_trusted(const ProductLanes& z, LaneMask trusted, ProductTile& products, std::size_t i) {
  const ProductLanes careful = load(products, i);
  store(scaled({hn::IfThenElse(trusted, z.re, careful.re), hn::IfThenElse(trusted, z.im, careful.im),
                hn::IfThenElse(trusted, z.passages, careful.passages)}),
        products, i);
}

void set_ones(ProductTile& products) {
  products.re.fill(1.0);
  products.im.fill(0.0);
  products.passages.fill(0.0);
}

// atan(t) / (2 pi) for t in [0, 1]: from that of the nearest c = k / 8, as atan t = atan c + atan((t - c) / (1 + t c)).
// The argument on the right is at most 1/16 in magnitude, so that the Taylor series to the 17th power is off by less
// than 2^-76 of it.
//
// Error, relative to the result: beyond 1/16 rad the result is at least half the table's entry, whose rounding (u) and
// that of the quotient t (u) thus count double. 1 + t c, the rest's quotient and sum, the product and the final sum add
// a u each: less than 9 u. (Some 5.5 u is the most that was found.)
HWY_INLINE Lanes arc_tangent_in_turns(Lanes t) {
  static constexpr std::array kTable = {
      // atan(k / 8) / (2 pi)
      0.0,
      0.019791712080282771005425836,
      0.038989565188684662730256445,
      0.057100125609954067523037813,
      0.073791808825216637087700538,
      0.088903842244676376557751794,
      0.102416382349566725824598924,
      0.114405347682526793903023851,
      0.125,
  };
  constexpr double kTurnsPerRadian = 0.159154943091895335768883763;
  const hn::RebindToSigned<Doubles> integers;
  const Lanes k = hn::Round(hn::Mul(hn::Set(d, 8.0), t));
  const Lanes c = hn::Mul(k, hn::Set(d, 0.125));
  const Lanes rest = hn::Div(hn::Sub(t, c), hn::Add(hn::Set(d, 1.0), hn::Mul(t, c)));
  const Lanes s = hn::Mul(rest, rest);
  Lanes tail = hn::Zero(d);
  for (int power = 17; power >= 3; power -= 2) {
    tail = hn::Mul(s, hn::Add(hn::Set(d, (power % 4 == 1 ? 1.0 : -1.0) / power), tail));
  }
  const Lanes radians = hn::Add(rest, hn::Mul(rest, tail));
  return hn::Add(hn::GatherIndex(d, kTable.data(), hn::ConvertTo(integers, k)),
                 hn::Mul(hn::Set(d, kTurnsPerRadian), radians));
}

// In [-1/2, 1/2], with the sign bit of im. Not both 0. Our own, because the arc tangents of C libraries round
// differently on CPUs with and without fused multiply-add.
HWY_INLINE Lanes argument_in_turns_of(Lanes re, Lanes im) {
  const Lanes x = hn::Abs(re), y = hn::Abs(im);
  const auto flat = hn::Le(y, x);
  const Lanes octant = arc_tangent_in_turns(hn::Div(hn::IfThenElse(flat, y, x), hn::IfThenElse(flat, x, y)));
  const Lanes quadrant = hn::IfThenElse(flat, octant, hn::Sub(hn::Set(d, 0.25), octant));
  return hn::CopySign(hn::IfNegativeThenElse(re, hn::Sub(hn::Set(d, 0.5), quadrant), quadrant), im);
}

// When all factors are multiplied.
void set_arguments(ProductTile& products, std::size_t count) {
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    hn::Store(argument_in_turns_of(hn::Load(d, &products.re[i]), hn::Load(d, &products.im[i])), d,
              &products.argument[i]);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#endif
