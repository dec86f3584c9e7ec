// Vectors in SIMD lanes. Included once per SIMD level.
#if defined(RAYCONE_CORE_VECTOR_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYCONE_CORE_VECTOR_LANES_INL_H_
#undef RAYCONE_CORE_VECTOR_LANES_INL_H_
#else
#define RAYCONE_CORE_VECTOR_LANES_INL_H_
#endif

#include "core/data/vec3.h"
#include "core/machine/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

struct VectorLanes {
  Lanes x, y, z;
};

HWY_INLINE VectorLanes in_all_lanes(const Vec3& v) { return {hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)}; }
HWY_INLINE VectorLanes minus(const VectorLanes& a, const VectorLanes& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE VectorLanes plus(const VectorLanes& a, const VectorLanes& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE VectorLanes times(Lanes s, const VectorLanes& a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}
HWY_INLINE Lanes dot(const VectorLanes& a, const VectorLanes& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE VectorLanes cross(const VectorLanes& a, const VectorLanes& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE VectorLanes if_then_else(LaneMask mask, const VectorLanes& a, const VectorLanes& b) {
  return {hn::IfThenElse(mask, a.x, b.x), hn::IfThenElse(mask, a.y, b.y), hn::IfThenElse(mask, a.z, b.z)};
}
HWY_INLINE VectorLanes if_then_else_zero(LaneMask mask, const VectorLanes& a) {
  return {hn::IfThenElseZero(mask, a.x), hn::IfThenElseZero(mask, a.y), hn::IfThenElseZero(mask, a.z)};
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#endif
