// Edges that need no predicate to tell that they have no factor. Included once per SIMD level.
#if defined(RAYCONE_CORE_LEVEL_EDGES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYCONE_CORE_LEVEL_EDGES_INL_H_
#undef RAYCONE_CORE_LEVEL_EDGES_INL_H_
#else
#define RAYCONE_CORE_LEVEL_EDGES_INL_H_
#endif

#include "core/machine/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

// Where an edge is level with a ray as a whole and does not meet its line: it is a tie without a factor, one of
// those that tied_factor() leaves out. Flat meshes have many of these in their plane.
HWY_INLINE LaneMask is_level_beside(Lanes a_y, Lanes a_z, Lanes b_y, Lanes b_z) {
  const auto is_zero = [](Lanes v, Lanes w) { return hn::And(hn::Eq(v, hn::Zero(d)), hn::Eq(w, hn::Zero(d))); };
  const auto same_side = [](Lanes v, Lanes w) {
    return hn::Or(hn::And(hn::Gt(v, hn::Zero(d)), hn::Gt(w, hn::Zero(d))),
                  hn::And(hn::Lt(v, hn::Zero(d)), hn::Lt(w, hn::Zero(d))));
  };
  return hn::Or(hn::And(is_zero(a_z, b_z), same_side(a_y, b_y)), hn::And(is_zero(a_y, b_y), same_side(a_z, b_z)));
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#endif
