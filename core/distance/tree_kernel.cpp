#include "core/distance/tree_kernel.h"

#include <algorithm>
#include <array>
#include <limits>

// Highway compiles what is between its markers once per SIMD level.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/distance/tree_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/distance/triangle_lanes-inl.h"
#include "core/machine/simd_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

using Bounds = TrianglePack::Column;

// Of the box [from, to] from the eight boxes of a node or pack.
template <class Boxes>
HWY_INLINE void set_bounds(const Boxes& boxes, const VectorLanes& from, const VectorLanes& to, Bounds& bounds) {
  for (std::size_t i = 0; i < TrianglePack::kWidth; i += hn::Lanes(d)) {
    const VectorLanes lower{hn::Load(d, &boxes.lower[0][i]), hn::Load(d, &boxes.lower[1][i]),
                            hn::Load(d, &boxes.lower[2][i])};
    const VectorLanes upper{hn::Load(d, &boxes.upper[0][i]), hn::Load(d, &boxes.upper[1][i]),
                            hn::Load(d, &boxes.upper[2][i])};
    hn::Store(squared_between(lower, upper, from, to), d, &bounds[i]);
  }
}

// The least square of a pack, of those that may be below `reach`.
HWY_INLINE double least_of(const TrianglePack& pack, const Vec3& p, const VectorLanes& ps, double reach) {
  alignas(64) Bounds squares;
  Lanes least = hn::Set(d, std::numeric_limits<double>::infinity());
  double with_care = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < TrianglePack::kWidth; i += hn::Lanes(d)) {
    const Squares some = squared(PackedTriangles(pack, i), ps);
    least = hn::Min(least, hn::IfThenElse(some.sure, some.values, least));
    if (hn::AllTrue(d, some.sure)) continue;
    set_bounds(pack, ps, ps, squares);
    alignas(64) std::array<double, TrianglePack::kWidth> sure;
    hn::Store(hn::IfThenElseZero(some.sure, hn::Set(d, 1.0)), d, sure.data());
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
      if (sure[lane] != 0.0 || squares[i + lane] >= reach) continue;
      with_care = std::min(with_care, pack.triangle(i + lane).squared(p));
    }
  }
  return std::min(with_care, hn::GetLane(hn::MinOfLanes(d, least)));
}

// At most 7 siblings wait per level, of 11 levels for 2^32 triangles.
constexpr std::size_t kMostWaiting = 12 * TrianglePack::kWidth;

double search_nearest(const DistanceTree& tree, const Vec3& p, double limit) {
  struct Candidate {
    double bound;
    std::uint32_t level;  // one above that of the node; 0: a pack
    std::uint32_t index;
  };
  std::array<Candidate, kMostWaiting> stack;
  std::size_t waiting = 0;
  stack[waiting++] = {0.0, static_cast<std::uint32_t>(tree.levels().size()), 0};
  double least = std::numeric_limits<double>::infinity();
  // What a triangle's own distance may be below that of its box, it may be below the least so far.
  double reach = beyond_error(limit);
  const VectorLanes ps = in_all_lanes(p);
  alignas(64) Bounds bounds;
  while (waiting > 0) {
    const Candidate here = stack[--waiting];
    if (here.bound >= reach) continue;
    if (here.level == 0) {
      least = std::min(least, least_of(tree.packs()[here.index], p, ps, reach));
      if (least == 0.0) return least;
      reach = std::min(reach, beyond_error(least));
      continue;
    }
    set_bounds(tree.levels()[here.level - 1][here.index], ps, ps, bounds);
    const std::size_t first = waiting;
    for (std::size_t i = 0; i < TrianglePack::kWidth; ++i) {
      if (!(bounds[i] < reach)) continue;
      // The farthest first: the nearest is on top of the stack.
      std::size_t at = waiting++;
      for (; at > first && stack[at - 1].bound < bounds[i]; --at) stack[at] = stack[at - 1];
      stack[at] = {bounds[i], here.level - 1, static_cast<std::uint32_t>(here.index * TrianglePack::kWidth + i)};
    }
  }
  return least;
}

void search_packs(const DistanceTree& tree, const Box& box, double limit, std::size_t most,
                  std::vector<std::uint32_t>& found) {
  struct Candidate {
    std::uint32_t level, index;
  };
  std::array<Candidate, kMostWaiting> stack;
  std::size_t waiting = 0;
  stack[waiting++] = {static_cast<std::uint32_t>(tree.levels().size()), 0};
  const VectorLanes from = in_all_lanes(box.lower), to = in_all_lanes(box.upper);
  alignas(64) Bounds bounds;
  found.clear();
  while (waiting > 0 && found.size() < most) {
    const Candidate here = stack[--waiting];
    if (here.level == 0) {
      found.push_back(here.index);
      continue;
    }
    set_bounds(tree.levels()[here.level - 1][here.index], from, to, bounds);
    for (std::size_t i = 0; i < TrianglePack::kWidth; ++i) {
      if (!(bounds[i] < limit)) continue;
      stack[waiting++] = {here.level - 1, static_cast<std::uint32_t>(here.index * TrianglePack::kWidth + i)};
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raycone {

NearestSearch nearest_search(SimdLevel level) { return RAYCONE_AT_LEVEL(level, search_nearest); }

PackSearch pack_search(SimdLevel level) { return RAYCONE_AT_LEVEL(level, search_packs); }

}  // namespace raycone
#endif
