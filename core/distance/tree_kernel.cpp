#include "core/distance/tree_kernel.h"

#include <algorithm>
#include <array>
#include <bit>
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

// Of the box [from, to] from the eight boxes of a node.
HWY_INLINE void set_bounds(const DistanceTree::Node& boxes, const VectorLanes& from, const VectorLanes& to,
                           Bounds& bounds) {
  for (std::size_t i = 0; i < TrianglePack::kWidth; i += hn::Lanes(d)) {
    const VectorLanes lower{hn::Load(d, &boxes.lower[0][i]), hn::Load(d, &boxes.lower[1][i]),
                            hn::Load(d, &boxes.lower[2][i])};
    const VectorLanes upper{hn::Load(d, &boxes.upper[0][i]), hn::Load(d, &boxes.upper[1][i]),
                            hn::Load(d, &boxes.upper[2][i])};
    hn::Store(squared_between(lower, upper, from, to), d, &bounds[i]);
  }
}

// The least square of triangles that are looked at one pack after the other, of those that may be below a limit.
class LeastSquare {
 public:
  // What a triangle's own distance may be below that of its box, it may be below the least so far.
  LeastSquare(const Vec3& p, double limit) : p_(p), ps_(in_all_lanes(p)), reach_(beyond_error(limit)) {}

  // What is not below this need not be looked at.
  [[nodiscard]] double reach() const { return reach_; }
  // So far, but for what is in doubt; after settle(), at all.
  [[nodiscard]] double least() const { return least_; }

  HWY_INLINE void look_at(const TrianglePack& pack) {
    for (std::size_t i = 0; i < TrianglePack::kWidth; i += hn::Lanes(d)) {
      const Squares some = squared(PackedTriangles(pack, i), ps_);
      if (hn::AllTrue(d, some.sure)) {
        lower_to(least_of(some.values));
        continue;
      }
      lower_to(least_of(hn::IfThenElse(some.sure, some.values, hn::Set(d, std::numeric_limits<double>::infinity()))));
      // Where they are not sure, they are distances from points of the triangles all the same, but for rounding.
      reach_ = std::min(reach_, beyond_error(beyond_error(least_of(some.values))));
      const Lanes bounds = least_with_care(some.values, hn::Load(d, &pack.direction_from[i]));
      const LaneMask settled = hn::Or(some.sure, hn::Ge(bounds, hn::Set(d, reach_)));
      if (!hn::AllTrue(d, settled)) doubt(pack, i, settled, bounds);
    }
  }

  // Takes care of those that may be the nearest ones, the likeliest first.
  void settle() {
    const auto end = doubtful_.begin() + static_cast<std::ptrdiff_t>(count_);
    std::sort(doubtful_.begin(), end, [](const Doubtful& a, const Doubtful& b) { return a.bound < b.bound; });
    for (auto it = doubtful_.begin(); it != end && it->bound < reach_; ++it)
      lower_to(it->pack->triangle(it->slot).squared(p_));
    count_ = 0;
  }

 private:
  struct Doubtful {
    const TrianglePack* pack;
    std::size_t slot;
    double bound;
  };

  static HWY_INLINE double least_of(Lanes squares) { return hn::GetLane(hn::MinOfLanes(d, squares)); }

  void lower_to(double square) {
    least_ = std::min(least_, square);
    reach_ = std::min(reach_, beyond_error(least_));
  }

  HWY_INLINE void doubt(const TrianglePack& pack, std::size_t first, LaneMask settled, Lanes bounds) {
    const std::uint32_t bits = bits_of(settled);
    alignas(64) std::array<double, TrianglePack::kWidth> bound;
    hn::Store(bounds, d, bound.data());
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
      if ((bits >> lane & 1U) != 0) continue;
      if (count_ == doubtful_.size()) settle();
      doubtful_[count_++] = {&pack, first + lane, bound[lane]};
    }
  }

  const Vec3& p_;
  VectorLanes ps_;
  double least_ = std::numeric_limits<double>::infinity(), reach_;
  std::array<Doubtful, 32> doubtful_;
  std::size_t count_ = 0;
};

// At most 7 siblings wait per level, of 11 levels for 2^32 triangles.
constexpr std::size_t kMostWaiting = 12 * TrianglePack::kWidth;

double search_nearest(const DistanceTree& tree, const Vec3& p, double limit) {
  struct Waiting {
    double bound;
    std::uint32_t level;  // one above that of the node; 0: a pack
    std::uint32_t index;
  };
  std::array<Waiting, kMostWaiting> stack;
  std::size_t waiting = 0;
  stack[waiting++] = {0.0, static_cast<std::uint32_t>(tree.levels().size()), 0};
  LeastSquare found(p, limit);
  const VectorLanes ps = in_all_lanes(p);
  alignas(64) Bounds bounds;
  while (waiting > 0) {
    const Waiting here = stack[--waiting];
    if (here.bound >= found.reach()) continue;
    if (here.level == 0) {
      found.look_at(tree.packs()[here.index]);
      if (found.least() == 0.0) return 0.0;
      continue;
    }
    set_bounds(tree.levels()[here.level - 1][here.index], ps, ps, bounds);
    const std::size_t first = waiting;
    const double reach = found.reach();
    for (std::size_t i = 0; i < TrianglePack::kWidth; ++i) {
      if (!(bounds[i] < reach)) continue;
      // The farthest first: the nearest is on top of the stack.
      std::size_t at = waiting++;
      for (; at > first && stack[at - 1].bound < bounds[i]; --at) stack[at] = stack[at - 1];
      stack[at] = {bounds[i], here.level - 1, static_cast<std::uint32_t>(here.index * TrianglePack::kWidth + i)};
    }
  }
  found.settle();
  return found.least();
}

void search_packs(const DistanceTree& tree, const Box& box, double limit, std::size_t most,
                  std::vector<std::uint32_t>& found) {
  struct Waiting {
    std::uint32_t level, index;
  };
  std::array<Waiting, kMostWaiting> stack;
  std::size_t waiting = 0;
  stack[waiting++] = {static_cast<std::uint32_t>(tree.levels().size()), 0};
  const VectorLanes from = in_all_lanes(box.lower), to = in_all_lanes(box.upper);
  alignas(64) Bounds bounds;
  found.clear();
  while (waiting > 0 && found.size() < most) {
    const Waiting here = stack[--waiting];
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

std::uint32_t search_slots(const TrianglePack& pack, const Vec3& p, double square) {
  const VectorLanes ps = in_all_lanes(p);
  const Lanes squares = hn::Set(d, square), reach = hn::Set(d, beyond_error(square));
  std::uint32_t found = 0;
  for (std::size_t i = 0; i < TrianglePack::kWidth; i += hn::Lanes(d)) {
    const Squares some = squared(PackedTriangles(pack, i), ps);
    found |= bits_of(hn::And(some.sure, hn::Eq(some.values, squares))) << i;
    const Lanes bounds = least_with_care(some.values, hn::Load(d, &pack.direction_from[i]));
    std::uint32_t doubtful = bits_of(hn::AndNot(some.sure, hn::Lt(bounds, reach)));
    for (; doubtful != 0; doubtful &= doubtful - 1) {
      const std::size_t slot = i + static_cast<std::size_t>(std::countr_zero(doubtful));
      if (pack.triangle(slot).squared(p) == square) found |= 1U << slot;
    }
  }
  return found;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raycone {

NearestSearch nearest_search(SimdLevel level) { return RAYCONE_AT_LEVEL(level, search_nearest); }

PackSearch pack_search(SimdLevel level) { return RAYCONE_AT_LEVEL(level, search_packs); }

SlotSearch slot_search(SimdLevel level) { return RAYCONE_AT_LEVEL(level, search_slots); }

}  // namespace raycone
#endif
