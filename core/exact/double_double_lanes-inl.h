// Numbers of about 106 bits in SIMD lanes: the operations of core/exact/double_double.h, in their order, so with the
// same bits. Included once per SIMD level.
#if defined(RAYCONE_CORE_DOUBLE_DOUBLE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYCONE_CORE_DOUBLE_DOUBLE_LANES_INL_H_
#undef RAYCONE_CORE_DOUBLE_DOUBLE_LANES_INL_H_
#else
#define RAYCONE_CORE_DOUBLE_DOUBLE_LANES_INL_H_
#endif

#include "core/exact/double_double.h"
#include "core/machine/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

struct DoubleDoubleLanes {
  Lanes high, low;
};

HWY_INLINE DoubleDoubleLanes accurate_in_lanes(const DoubleDouble& a) {
  return {hn::Set(d, a.high), hn::Set(d, a.low)};
}

HWY_INLINE DoubleDoubleLanes exact_sum(Lanes a, Lanes b) {
  const Lanes sum = hn::Add(a, b), part = hn::Sub(sum, a);
  return {sum, hn::Add(hn::Sub(a, hn::Sub(sum, part)), hn::Sub(b, part))};
}

HWY_INLINE DoubleDoubleLanes exact_sum_of_ordered(Lanes a, Lanes b) {
  const Lanes sum = hn::Add(a, b);
  return {sum, hn::Sub(b, hn::Sub(sum, a))};
}

HWY_INLINE DoubleDoubleLanes exact_product(Lanes a, Lanes b) {
  const Lanes splitter = hn::Set(d, 0x1p27 + 1);
  const Lanes a_split = hn::Mul(splitter, a), b_split = hn::Mul(splitter, b);
  const Lanes a_high = hn::Sub(a_split, hn::Sub(a_split, a)), b_high = hn::Sub(b_split, hn::Sub(b_split, b));
  const Lanes a_low = hn::Sub(a, a_high), b_low = hn::Sub(b, b_high);
  const Lanes product = hn::Mul(a, b);
  const Lanes rest = hn::Add(hn::Sub(hn::Mul(a_high, b_high), product), hn::Mul(a_high, b_low));
  return {product, hn::Add(hn::Add(rest, hn::Mul(a_low, b_high)), hn::Mul(a_low, b_low))};
}

HWY_INLINE DoubleDoubleLanes operator+(const DoubleDoubleLanes& a, const DoubleDoubleLanes& b) {
  DoubleDoubleLanes sum = exact_sum(a.high, b.high);
  const DoubleDoubleLanes rest = exact_sum(a.low, b.low);
  sum = exact_sum_of_ordered(sum.high, hn::Add(sum.low, rest.high));
  return exact_sum_of_ordered(sum.high, hn::Add(sum.low, rest.low));
}

HWY_INLINE DoubleDoubleLanes operator-(const DoubleDoubleLanes& a, const DoubleDoubleLanes& b) {
  return a + DoubleDoubleLanes{hn::Neg(b.high), hn::Neg(b.low)};
}

HWY_INLINE DoubleDoubleLanes operator*(const DoubleDoubleLanes& a, const DoubleDoubleLanes& b) {
  const DoubleDoubleLanes product = exact_product(a.high, b.high);
  const Lanes rest = hn::Add(hn::Mul(a.high, b.low), hn::Mul(a.low, b.high));
  return exact_sum_of_ordered(product.high, hn::Add(product.low, rest));
}

HWY_INLINE DoubleDoubleLanes operator/(const DoubleDoubleLanes& a, const DoubleDoubleLanes& b) {
  const Lanes quotient = hn::Div(a.high, b.high);
  const DoubleDoubleLanes rest = a - DoubleDoubleLanes{quotient, hn::Zero(d)} * b;
  return exact_sum_of_ordered(quotient, hn::Div(rest.high, b.high));
}

HWY_INLINE LaneMask operator<(const DoubleDoubleLanes& a, const DoubleDoubleLanes& b) {
  return hn::Or(hn::Lt(a.high, b.high), hn::And(hn::Eq(a.high, b.high), hn::Lt(a.low, b.low)));
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#endif
