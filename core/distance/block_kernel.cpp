// The triangles near a block are looked through for each part of it, of 4^3 samples, and those near a part for each
// group of 2^3. Those are left of which half-spaces do not tell that another triangle is nearer to all of the samples
// (docs/method.md, "The nearest triangle").
#include "core/distance/block_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

// Highway compiles what is between its markers once per SIMD level.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/distance/block_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/distance/near_triangles-inl.h"
#include "core/distance/triangle_lanes-inl.h"
#include "core/machine/simd_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

constexpr std::size_t kPartSide = 4, kGroupSide = 2, kGroup = 8;  // samples

// Eight samples; the last ones are repeated where there are fewer.
struct Group {
  alignas(64) std::array<double, kGroup> x, y, z, least;
  std::array<std::size_t, kGroup> index;  // in BlockScratch::squares

  Group(const BlockTask& task, const SampleBox& box) {
    const LatticeRows& rows = task.rows;
    for (std::size_t n = 0; n < kGroup; ++n) {
      const std::size_t i = std::min(box.begin[0] + n % 2, box.end[0] - 1);
      const std::size_t j = std::min(box.begin[1] + n / 2 % 2, box.end[1] - 1);
      const std::size_t k = std::min(box.begin[2] + n / 4, box.end[2] - 1);
      x[n] = rows.xs[i];
      y[n] = rows.ys[j];
      z[n] = rows.zs[k];
      index[n] = index_in_block({i - task.block.begin[0], j - task.block.begin[1], k - task.block.begin[2]});
    }
    least.fill(kNowhere);
  }
};

// Samples for which lanes are not sure.
void take_care(const TrianglePack& pack, std::size_t slot, std::size_t first, LaneMask sure, Group& group) {
  alignas(64) std::array<double, kWidth> is_sure;
  hn::Store(hn::IfThenElseZero(sure, hn::Set(d, 1.0)), d, is_sure.data());
  const TriangleDistance triangle = pack.triangle(slot);
  std::optional<AccurateTriangle> accurate;
  for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
    if (is_sure[lane] != 0.0) continue;
    const std::size_t n = first + lane;
    group.least[n] = std::min(group.least[n], triangle.squared({group.x[n], group.y[n], group.z[n]}, accurate));
  }
}

// Whether squares that are not sure are above `least` with care, too.
HWY_INLINE LaneMask is_farther(const TrianglePack& pack, std::size_t slot, Lanes squares, Lanes least) {
  const double off = 1e-12 * pack.direction_from[slot];  // more than the square of what the closest point is off by
  const Lanes reach = hn::Add(hn::Mul(least, hn::Set(d, kBeyondErrorFactor)), hn::Set(d, kBeyondErrorTerm));
  return hn::Gt(hn::Sub(squares, hn::Set(d, off)), reach);
}

// Returns the largest of the group's least squares.
HWY_INLINE double lower_to(const TrianglePack& pack, std::size_t slot, Group& group) {
  Lanes largest = hn::Zero(d);
  for (std::size_t n = 0; n < kGroup; n += hn::Lanes(d)) {
    const VectorLanes ps{hn::Load(d, &group.x[n]), hn::Load(d, &group.y[n]), hn::Load(d, &group.z[n])};
    const Squares some = squared(SameTriangle(pack, slot), ps);
    const Lanes before = hn::Load(d, &group.least[n]);
    const Lanes least = hn::IfThenElse(some.sure, hn::Min(before, some.values), before);
    hn::Store(least, d, &group.least[n]);
    const LaneMask settled = hn::Or(some.sure, is_farther(pack, slot, some.values, least));
    if (!hn::AllTrue(d, settled)) take_care(pack, slot, n, settled, group);
    largest = hn::Max(largest, hn::Load(d, &group.least[n]));
  }
  return hn::GetLane(hn::MaxOfLanes(d, largest));
}

// The distance of triangles from a box is this at least. `from`: from the middle, of which the bearings are, to that of
// the box.
HWY_INLINE Lanes least_distances(const Bearings& bearings, const VectorLanes& from, const VectorLanes& extent) {
  const VectorLanes& away = bearings.away;
  return hn::Sub(hn::Add(bearings.distances, dot(away, from)),
                 dot({hn::Abs(away.x), hn::Abs(away.y), hn::Abs(away.z)}, extent));
}

// Sets `bounds`, one per triangle, to what its squares are not below at any sample of the box `here`; `slack`: of the
// largest distance that counts. Returns the number of the triangle that seems to be nearest to the box.
HWY_INLINE std::size_t find_bounds(const NearTriangles& near, const Middle& middle, const Middle& here, double slack,
                                   std::vector<double>& bounds) {
  const VectorLanes from = in_all_lanes(here.center - middle.center), extent = in_all_lanes(here.extent);
  const VectorLanes twice_center = in_all_lanes(2.0 * here.center);
  Lanes least = hn::Set(d, kNowhere), number = hn::Zero(d);
  if (bounds.size() < near.count + kWidth) bounds.resize(near.count + kWidth);
  for (std::size_t n = 0; n < near.count; n += hn::Lanes(d)) {
    const BoxLanes boxes = boxes_of(near, n);
    const Lanes distances = hn::Sub(least_distances(bearings_of(near, n), from, extent), hn::Set(d, slack));
    const Lanes positive = hn::Max(distances, hn::Zero(d));
    const Lanes squares = squared_between(boxes.lower, boxes.upper, here.lower, here.upper);
    hn::StoreU(hn::Max(squares, hn::Mul(positive, positive)), d, &bounds[n]);
    const VectorLanes to_box = minus(plus(boxes.lower, boxes.upper), twice_center);
    const Lanes square = dot(to_box, to_box);
    const LaneMask nearer = hn::Lt(square, least);
    least = hn::IfThenElse(nearer, square, least);
    number = hn::IfThenElse(nearer, hn::Iota(d, static_cast<double>(n)), number);
  }
  const LaneMask is_least = hn::Eq(least, hn::MinOfLanes(d, least));
  return static_cast<std::size_t>(
      hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(is_least, number, hn::Set(d, kNowhere)))));
}

// Whether the triangle's box and its half-space, of the bearing from `middle`, leave it nearer to a sample than what
// was found.
HWY_INLINE bool may_be_nearer(const NearTriangles& near, std::size_t number, const Vec3& middle, double slack,
                              const Group& group) {
  const Lanes distance = hn::Set(d, near.distances[number] - slack);
  const VectorLanes away = in_all_lanes({near.away[0][number], near.away[1][number], near.away[2][number]});
  const VectorLanes lower = in_all_lanes({near.lower[0][number], near.lower[1][number], near.lower[2][number]});
  const VectorLanes upper = in_all_lanes({near.upper[0][number], near.upper[1][number], near.upper[2][number]});
  LaneMask nearer = hn::FirstN(d, 0);
  for (std::size_t n = 0; n < kGroup; n += hn::Lanes(d)) {
    const VectorLanes ps{hn::Load(d, &group.x[n]), hn::Load(d, &group.y[n]), hn::Load(d, &group.z[n])};
    const Lanes least = hn::Load(d, &group.least[n]);
    const Lanes bound = hn::Max(hn::Add(distance, dot(away, minus(ps, in_all_lanes(middle)))), hn::Zero(d));
    const Lanes limit = hn::Add(hn::Mul(least, hn::Set(d, kBeyondErrorFactor)), hn::Set(d, kBeyondErrorTerm));
    nearer = hn::Or(
        nearer, hn::And(hn::Le(hn::Mul(bound, bound), least), hn::Lt(squared_between(lower, upper, ps, ps), limit)));
  }
  return !hn::AllFalse(d, nearer);
}

// Of the triangles of scratch.of_part, with bearings from `middle`.
void fill_group(const BlockTask& task, const SampleBox& box, const Middle& middle, BlockScratch& scratch) {
  const NearTriangles& near = scratch.of_part;
  const Middle here(task.rows, box);
  Group group(task, box);
  const auto look_at = [&](std::size_t number) {
    const auto place = static_cast<std::size_t>(near.places[number]);
    return beyond_error(lower_to(scratch.packed[place / kStride], place % kStride, group));
  };
  const double slack = slack_of(task.reach * kSlack, middle.radius);
  const std::size_t first = find_bounds(near, middle, here, slack, scratch.bounds);
  double most = std::min(square_of_reach(task.reach), look_at(first));
  for (std::size_t n = 0; n < near.count; n += hn::Lanes(d)) {
    const Lanes bounds = hn::LoadU(d, &scratch.bounds[n]);
    LaneMask wanted = hn::Le(bounds, hn::Set(d, most));
    while (!hn::AllFalse(d, wanted)) {
      const auto lane = static_cast<std::size_t>(hn::FindFirstTrue(d, wanted));
      const bool worth_it = n + lane != first && may_be_nearer(near, n + lane, middle.center, slack, group);
      if (worth_it) most = std::min(most, look_at(n + lane));
      wanted = hn::AndNot(hn::FirstN(d, lane + 1), worth_it ? hn::Le(bounds, hn::Set(d, most)) : wanted);
    }
  }
  for (std::size_t n = 0; n < kGroup; ++n) scratch.squares[group.index[n]] = group.least[n];
}

// visit(part) of the parts of a box, of `side` samples along each axis.
template <class Visit>
HWY_INLINE void for_each_part(const SampleBox& box, std::size_t side, const Visit& visit) {
  SampleBox part{};
  const auto set = [&](std::size_t axis, std::size_t begin) {
    part.begin[axis] = begin;
    part.end[axis] = std::min(begin + side, box.end[axis]);
  };
  for (std::size_t k = box.begin[2]; k < box.end[2]; k += side) {
    set(2, k);
    for (std::size_t j = box.begin[1]; j < box.end[1]; j += side) {
      set(1, j);
      for (std::size_t i = box.begin[0]; i < box.end[0]; i += side) {
        set(0, i);
        visit(part);
      }
    }
  }
}

// The triangles near the block, copied together.
void find_triangles(const BlockTask& task, BlockScratch& scratch) {
  const Middle middle(task.rows, task.block);
  // Half-spaces tell nothing of triangles that are nearer than the block is large.
  const bool is_far = task.reach > 2 * middle.radius;
  find_near(task, middle, is_far, scratch.of_block);
  if (is_far) {
    keep_nearest(middle, scratch.of_block);
  } else {
    close(scratch.of_block);
  }
  pack_together(task.tree, scratch.of_block, scratch.packed);
}

void fill_block(const BlockTask& task, BlockScratch& scratch) {
  scratch.squares.fill(kNowhere);
  find_triangles(task, scratch);
  if (scratch.of_block.count == 0) return;
  for_each_part(task.block, kPartSide, [&](const SampleBox& part) {
    const Middle of_part(task.rows, part);
    find_in_reach(task, of_part, scratch.packed, scratch.of_block, scratch.of_part);
    if (scratch.of_part.count == 0) return;
    keep_nearest(of_part, scratch.of_part);
    for_each_part(part, kGroupSide, [&](const SampleBox& box) { fill_group(task, box, of_part, scratch); });
  });
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raycone {
BlockKernel block_kernel(SimdLevel level) { return RAYCONE_AT_LEVEL(level, fill_block); }

}  // namespace raycone
#endif
