// Squares of distances in SIMD lanes, to the bit those of TriangleDistance: what kernels share. Included once per SIMD
// level.
#if defined(RAYCONE_CORE_DISTANCE_TRIANGLE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYCONE_CORE_DISTANCE_TRIANGLE_LANES_INL_H_
#undef RAYCONE_CORE_DISTANCE_TRIANGLE_LANES_INL_H_
#else
#define RAYCONE_CORE_DISTANCE_TRIANGLE_LANES_INL_H_
#endif

#include <cstddef>
#include <limits>

#include "core/distance/triangle_pack.h"
#include "core/machine/vector_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

constexpr std::size_t kWidth = TrianglePack::kWidth;
static_assert(hn::MaxLanes(d) <= kWidth);

// One triangle in all lanes.
class SameTriangle {
 public:
  SameTriangle(const TrianglePack& pack, std::size_t slot) : pack_(pack), slot_(slot) {}
  HWY_INLINE Lanes operator()(const TrianglePack::Column& column) const { return hn::Set(d, column[slot_]); }
  HWY_INLINE const TrianglePack& pack() const { return pack_; }

 private:
  const TrianglePack& pack_;
  std::size_t slot_;
};

// Triangles of a pack from `slot` on.
class PackedTriangles {
 public:
  PackedTriangles(const TrianglePack& pack, std::size_t slot) : pack_(pack), slot_(slot) {}
  HWY_INLINE Lanes operator()(const TrianglePack::Column& column) const { return hn::Load(d, &column[slot_]); }
  HWY_INLINE const TrianglePack& pack() const { return pack_; }

 private:
  const TrianglePack& pack_;
  std::size_t slot_;
};

template <class Triangles>
HWY_INLINE VectorLanes vectors(const Triangles& triangles, const TrianglePack::Columns& columns) {
  return {triangles(columns[0]), triangles(columns[1]), triangles(columns[2])};
}

// Squares; where they are not sure, TriangleDistance takes more care.
struct Squares {
  Lanes values;
  LaneMask sure;
  VectorLanes rest;  // from the closest points
};

HWY_INLINE VectorLanes rest_to_edge(const VectorLanes& from_corner, const VectorLanes& edge, Lanes inverse_square) {
  const Lanes along = hn::Min(hn::Max(hn::Mul(dot(from_corner, edge), inverse_square), hn::Zero(d)), hn::Set(d, 1.0));
  return minus(from_corner, times(along, edge));
}

// The same operations in the same order as TriangleDistance::squared().
template <class Triangles>
HWY_INLINE Squares squared(const Triangles& t, const VectorLanes& p) {
  const TrianglePack& pack = t.pack();
  const VectorLanes a = vectors(t, pack.corners[0]), b = vectors(t, pack.corners[1]), c = vectors(t, pack.corners[2]);
  const Lanes zero = hn::Zero(d), one = hn::Set(d, 1.0), infinity = hn::Set(d, std::numeric_limits<double>::infinity());
  const VectorLanes from_a = minus(p, a);
  const Lanes v = dot(from_a, vectors(t, pack.to_v)), w = dot(from_a, vectors(t, pack.to_w));
  const LaneMask beyond_ab = hn::Lt(w, zero), beyond_bc = hn::Gt(hn::Add(v, w), one), beyond_ca = hn::Lt(v, zero);
  const Lanes shape = t(pack.shape);
  const LaneMask outside = hn::Or(hn::Or(beyond_ab, beyond_bc), hn::Or(beyond_ca, hn::Gt(shape, one)));
  const LaneMask all_edges = hn::Gt(shape, zero);
  const VectorLanes ab = minus(b, a), ca = minus(a, c);
  VectorLanes rest = plus(minus(from_a, times(v, ab)), times(w, ca));
  Lanes least = hn::IfThenElse(outside, infinity, dot(rest, rest));
  const auto look_at = [&](LaneMask beyond, const VectorLanes& corner, const VectorLanes& edge, std::size_t number) {
    const LaneMask wanted = hn::Or(beyond, all_edges);
    const VectorLanes to_edge = rest_to_edge(minus(p, corner), edge, t(pack.inverse_square[number]));
    const Lanes square = dot(to_edge, to_edge);
    const LaneMask nearer = hn::And(wanted, hn::Lt(square, least));
    least = hn::IfThenElse(nearer, square, least);
    rest = {hn::IfThenElse(nearer, to_edge.x, rest.x), hn::IfThenElse(nearer, to_edge.y, rest.y),
            hn::IfThenElse(nearer, to_edge.z, rest.z)};
  };
  look_at(beyond_ab, a, ab, 0);
  look_at(beyond_bc, b, minus(c, b), 1);
  look_at(beyond_ca, c, ca, 2);
  return {least, hn::Or(hn::Ge(least, t(pack.sure_from)), hn::Le(least, t(pack.sure_up_to))), rest};
}

// What squares that are not sure are with care, at least. `direction_from`: of their triangles.
HWY_INLINE Lanes least_with_care(Lanes squares, Lanes direction_from) {
  constexpr double kOff = 1e-12;  // times this, more than the square of what the closest point is off by
  return hn::Sub(squares, hn::Mul(hn::Set(d, kOff), direction_from));
}

// Squares of the distances from boxes to boxes, but for rounding.
HWY_INLINE Lanes squared_between(const VectorLanes& lower, const VectorLanes& upper, const VectorLanes& from,
                                 const VectorLanes& to) {
  const VectorLanes below = minus(lower, to), above = minus(from, upper);
  const VectorLanes between{hn::Max(hn::Max(below.x, above.x), hn::Zero(d)),
                            hn::Max(hn::Max(below.y, above.y), hn::Zero(d)),
                            hn::Max(hn::Max(below.z, above.z), hn::Zero(d))};
  return dot(between, between);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#endif
