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
#include "core/exact/double_double_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

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
