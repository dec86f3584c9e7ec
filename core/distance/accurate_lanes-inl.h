// Accurate distances in SIMD lanes, to the bit those of AccurateTriangle. Included once per SIMD level.
#if defined(RAYCONE_CORE_ACCURATE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYCONE_CORE_ACCURATE_LANES_INL_H_
#undef RAYCONE_CORE_ACCURATE_LANES_INL_H_
#else
#define RAYCONE_CORE_ACCURATE_LANES_INL_H_
#endif

#include <cstddef>
#include <limits>

#include "core/distance/accurate_distance.h"
#include "core/distance/triangle_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

// The operations of core/exact/double_double.h, in their order.
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

struct AccurateLanes {
  DoubleDoubleLanes x, y, z;

  [[nodiscard]] HWY_INLINE Lanes rounded_square() const {
    const VectorLanes rounded{x.high, y.high, z.high};
    return dot(rounded, rounded);
  }
};

HWY_INLINE AccurateLanes accurate_in_lanes(const DoubleDoubleVec3& a) {
  return {accurate_in_lanes(a.x), accurate_in_lanes(a.y), accurate_in_lanes(a.z)};
}
HWY_INLINE AccurateLanes exact_difference(const VectorLanes& a, const Vec3& b) {
  return {exact_sum(a.x, hn::Set(d, -b.x)), exact_sum(a.y, hn::Set(d, -b.y)), exact_sum(a.z, hn::Set(d, -b.z))};
}
HWY_INLINE AccurateLanes operator-(const AccurateLanes& a, const AccurateLanes& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
HWY_INLINE AccurateLanes operator*(const DoubleDoubleLanes& s, const AccurateLanes& a) {
  return {s * a.x, s * a.y, s * a.z};
}
HWY_INLINE DoubleDoubleLanes dot(const AccurateLanes& a, const AccurateLanes& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

// To the segment of edge i.
HWY_INLINE Lanes square_to_segment(const AccurateTriangle::Parts& t, std::size_t i, const VectorLanes& p) {
  const AccurateLanes to_query = exact_difference(p, t.corners[i]);
  if (t.edge_squares[i].high < AccurateTriangle::kPoint) return to_query.rounded_square();
  const DoubleDoubleLanes zero{hn::Zero(d), hn::Zero(d)}, one{hn::Set(d, 1.0), hn::Zero(d)};
  const AccurateLanes edge = accurate_in_lanes(t.edges[i]);
  DoubleDoubleLanes along = dot(to_query, edge) / accurate_in_lanes(t.edge_squares[i]);
  const auto replace = [&](LaneMask where, const DoubleDoubleLanes& by) {
    along = {hn::IfThenElse(where, by.high, along.high), hn::IfThenElse(where, by.low, along.low)};
  };
  replace(along < zero, zero);
  replace(one < along, one);
  return (to_query - along * edge).rounded_square();
}

// To the plane; infinity where its closest point is outside of the triangle.
HWY_INLINE Lanes square_to_plane(const AccurateTriangle::Parts& t, const VectorLanes& p) {
  const Lanes infinity = hn::Set(d, std::numeric_limits<double>::infinity());
  if (t.is_thin) return infinity;
  const DoubleDoubleLanes zero{hn::Zero(d), hn::Zero(d)}, one{hn::Set(d, 1.0), hn::Zero(d)};
  const AccurateLanes edge = accurate_in_lanes(t.edges[t.longest]), height = accurate_in_lanes(t.height);
  const AccurateLanes to_query = exact_difference(p, t.corners[t.longest]);
  const DoubleDoubleLanes along = dot(to_query, edge) / accurate_in_lanes(t.edge_squares[t.longest]);
  const AccurateLanes beside = to_query - along * edge;
  const DoubleDoubleLanes up = dot(beside, height) / accurate_in_lanes(t.height_square),
                          apex = accurate_in_lanes(t.apex);
  const LaneMask outside = hn::Or(up < zero, hn::Or(along < up * apex, one - along < up * (one - apex)));
  return hn::IfThenElse(outside, infinity, (beside - up * height).rounded_square());
}

// As AccurateTriangle::squared_distance(), of the lanes that are `wanted`; others have any number.
HWY_INLINE Lanes squared_distances(const AccurateTriangle& triangle, const VectorLanes& p, LaneMask wanted) {
  const AccurateTriangle::Parts& t = triangle.parts();
  const Lanes to_plane = square_to_plane(t, p);
  const LaneMask outside = hn::Eq(to_plane, hn::Set(d, std::numeric_limits<double>::infinity()));
  if (hn::AllFalse(d, hn::And(wanted, outside))) return to_plane;
  const Lanes to_edges =
      hn::Min(square_to_segment(t, 0, p), hn::Min(square_to_segment(t, 1, p), square_to_segment(t, 2, p)));
  return hn::IfThenElse(outside, to_edges, to_plane);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#endif  // RAYCONE_CORE_ACCURATE_LANES_INL_H_
