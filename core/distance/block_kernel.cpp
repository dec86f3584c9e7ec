// The triangles near a block are looked through for each part of it, of 4^3 samples, and those near a part for each
// group of 2^3. Those are left of which half-spaces do not tell that another triangle is nearer to all of the samples
// (docs/method.md, "The nearest triangle").
#include "core/distance/block_kernel.h"

#include <algorithm>
#include <array>

// Highway compiles what is between its markers once per SIMD level.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/distance/block_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/distance/accurate_lanes-inl.h"
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
      index[n] = place_in_block({i - task.block.begin[0], j - task.block.begin[1], k - task.block.begin[2]});
    }
    least.fill(kNowhere);
  }
};

// Where the samples from n on are.
HWY_INLINE VectorLanes points_of(const Group& group, std::size_t n) {
  return {hn::Load(d, &group.x[n]), hn::Load(d, &group.y[n]), hn::Load(d, &group.z[n])};
}

// beyond_error() in each lane.
HWY_INLINE Lanes beyond_errors(Lanes squares) {
  return hn::Add(hn::Mul(squares, hn::Set(d, kBeyondErrorFactor)), hn::Set(d, kBeyondErrorTerm));
}

// A triangle of a block.
struct PlacedTriangle {
  const TrianglePack& pack;
  std::size_t slot, place;
};

// Samples for which lanes are not sure. Of thin triangles, all of them want the same.
void take_care(const PlacedTriangle& placed, std::size_t first, LaneMask sure, AccurateTriangles& accurate,
               Group& group) {
  if (placed.pack.is_thin(placed.slot)) {
    const VectorLanes ps = points_of(group, first);
    const Lanes least = hn::Load(d, &group.least[first]);
    const AccurateTriangle& triangle = accurate.at(placed.place, [&] { return placed.pack.accurate(placed.slot); });
    const Lanes squares = squared_distances(triangle, ps, hn::Not(sure));
    hn::Store(hn::IfThenElse(sure, least, hn::Min(least, squares)), d, &group.least[first]);
    return;
  }
  const std::uint32_t bits = bits_of(sure);
  const TriangleDistance triangle = placed.pack.triangle(placed.slot);
  for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
    if ((bits >> lane & 1U) != 0) continue;
    const std::size_t n = first + lane;
    group.least[n] = std::min(group.least[n], triangle.squared({group.x[n], group.y[n], group.z[n]}));
  }
}

// Returns the largest of the group's least squares.
HWY_INLINE double lower_to(const PlacedTriangle& placed, AccurateTriangles& accurate, Group& group) {
  const TrianglePack& pack = placed.pack;
  const std::size_t slot = placed.slot;
  Lanes largest = hn::Zero(d);
  for (std::size_t n = 0; n < kGroup; n += hn::Lanes(d)) {
    const VectorLanes ps = points_of(group, n);
    const Squares some = squared(SameTriangle(pack, slot), ps);
    const Lanes before = hn::Load(d, &group.least[n]);
    const Lanes least = hn::IfThenElse(some.sure, hn::Min(before, some.values), before);
    hn::Store(least, d, &group.least[n]);
    const Lanes reach = beyond_errors(least);
    const Lanes direction_from = hn::Set(d, pack.direction_from[slot]);
    const LaneMask settled = hn::Or(some.sure, hn::Gt(least_with_care(some.values, direction_from), reach));
    if (!hn::AllTrue(d, settled)) take_care(placed, n, settled, accurate, group);
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

struct FirstLook {
  std::size_t number;  // of the triangle that seems to be nearest to the box
  double bound;        // the least one
};

// Sets `bounds`, one per triangle, to what its squares are not below at any sample of the box `here`; `slack`: of the
// largest distance that counts.
HWY_INLINE FirstLook find_bounds(const NearTriangles& near, const Middle& middle, const Middle& here, double slack,
                                 std::vector<double>& bounds) {
  const VectorLanes from = in_all_lanes(here.center - middle.center), extent = in_all_lanes(here.extent);
  const VectorLanes twice_center = in_all_lanes(2.0 * here.center);
  Lanes least = hn::Set(d, kNowhere), number = hn::Zero(d), least_bound = hn::Set(d, kNowhere);
  if (bounds.size() < near.count + kWidth) bounds.resize(near.count + kWidth);
  for (std::size_t n = 0; n < near.count; n += hn::Lanes(d)) {
    const BoxLanes boxes = boxes_of(near, n);
    const Lanes distances = hn::Sub(least_distances(bearings_of(near, n), from, extent), hn::Set(d, slack));
    const Lanes positive = hn::Max(distances, hn::Zero(d));
    const Lanes squares = squared_between(boxes.lower, boxes.upper, here.lower, here.upper);
    const Lanes bound = hn::Max(squares, hn::Mul(positive, positive));
    hn::StoreU(bound, d, &bounds[n]);
    least_bound = hn::Min(least_bound, bound);
    const VectorLanes to_box = minus(plus(boxes.lower, boxes.upper), twice_center);
    const Lanes square = dot(to_box, to_box);
    const LaneMask nearer = hn::Lt(square, least);
    least = hn::IfThenElse(nearer, square, least);
    number = hn::IfThenElse(nearer, hn::Iota(d, static_cast<double>(n)), number);
  }
  const LaneMask is_least = hn::Eq(least, hn::MinOfLanes(d, least));
  const double first = hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(is_least, number, hn::Set(d, kNowhere))));
  return {static_cast<std::size_t>(first), hn::GetLane(hn::MinOfLanes(d, least_bound))};
}

// Half-spaces from the middle of a part, of the triangles near it.
struct HalfSpaces {
  Vec3 middle;
  double slack;
  bool are_used;  // where triangles are near the part, boxes tell as much in less time

  // The triangle's is farther from samples than they are from a triangle that was found.
  [[nodiscard]] HWY_INLINE LaneMask tell(const NearTriangles& near, std::size_t number, const VectorLanes& ps,
                                         Lanes least) const {
    const VectorLanes away = in_all_lanes({near.away[0][number], near.away[1][number], near.away[2][number]});
    const Lanes distance = hn::Set(d, near.distances[number] - slack);
    const Lanes bound = hn::Max(hn::Add(distance, dot(away, minus(ps, in_all_lanes(middle)))), hn::Zero(d));
    return hn::Gt(hn::Mul(bound, bound), least);
  }
};

// Whether the triangle's box, and its half-space, leave it nearer to a sample than what was found.
HWY_INLINE bool may_be_nearer(const NearTriangles& near, std::size_t number, const HalfSpaces& half_spaces,
                              const Group& group) {
  const VectorLanes lower = in_all_lanes({near.lower[0][number], near.lower[1][number], near.lower[2][number]});
  const VectorLanes upper = in_all_lanes({near.upper[0][number], near.upper[1][number], near.upper[2][number]});
  LaneMask nearer = hn::FirstN(d, 0);
  for (std::size_t n = 0; n < kGroup; n += hn::Lanes(d)) {
    const VectorLanes ps = points_of(group, n);
    const Lanes least = hn::Load(d, &group.least[n]);
    const Lanes limit = beyond_errors(least);
    LaneMask here = hn::Lt(squared_between(lower, upper, ps, ps), limit);
    if (half_spaces.are_used) here = hn::AndNot(half_spaces.tell(near, number, ps, least), here);
    nearer = hn::Or(nearer, here);
  }
  return !hn::AllFalse(d, nearer);
}

// Numbers of those but `first` whose bounds are not above `most`. Returns how many there are.
HWY_INLINE std::size_t find_candidates(std::size_t count, std::size_t first, double most, BlockScratch& scratch) {
  if (scratch.candidates.size() < count + kWidth) scratch.candidates.resize(count + kWidth);
  scratch.bounds[first] = kNowhere;
  const Places integers;
  std::size_t found = 0;
  for (std::size_t n = 0; n < count; n += hn::Lanes(d)) {
    const LaneMask wanted = hn::Le(hn::LoadU(d, &scratch.bounds[n]), hn::Set(d, most));
    if (hn::AllFalse(d, wanted)) continue;
    const auto numbers = hn::Iota(integers, static_cast<std::int64_t>(n));
    hn::StoreU(ToFront<Doubles>(wanted)(integers, numbers), integers, &scratch.candidates[found]);
    found += hn::CountTrue(d, wanted);
  }
  return found;
}

// Of the triangles of scratch.of_part, with bearings from `middle`.
void fill_group(const BlockTask& task, const SampleBox& box, const Middle& middle, BlockScratch& scratch) {
  const NearTriangles& near = scratch.of_part;
  const Middle here(task.rows, box);
  Group group(task, box);
  const auto look_at = [&](std::size_t number) {
    const auto place = static_cast<std::size_t>(near.places[number]);
    return beyond_error(lower_to({scratch.packed[place / kWidth], place % kWidth, place}, scratch.accurate, group));
  };
  const double slack = slack_of(task.reach * kReachSlack, middle.radius);
  const FirstLook first = find_bounds(near, middle, here, slack, scratch.bounds);
  if (first.bound > square_of_reach(task.reach)) return;
  double most = std::min(square_of_reach(task.reach), look_at(first.number));
  const HalfSpaces half_spaces{middle.center, slack, most > middle.radius * middle.radius};
  const std::size_t count = find_candidates(near.count, first.number, most, scratch);
  for (std::size_t n = 0; n < count; ++n) {
    const auto number = static_cast<std::size_t>(scratch.candidates[n]);
    if (scratch.bounds[number] > most || !may_be_nearer(near, number, half_spaces, group)) continue;
    most = std::min(most, look_at(number));
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
  scratch.accurate.forget_all();
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

bool take_roots(std::span<double, kSamplesOfBlock> squares, const PowerOfTwo& to_world, double band) {
  const Lanes factor = hn::Set(d, to_world.factors()[0]), other = hn::Set(d, to_world.factors()[1]);
  const Lanes most = hn::Set(d, band);
  LaneMask below = hn::FirstN(d, 0);
  for (std::size_t n = 0; n < squares.size(); n += hn::Lanes(d)) {
    const Lanes distances = hn::Mul(hn::Mul(hn::Sqrt(hn::LoadU(d, &squares[n])), factor), other);
    below = hn::Or(below, hn::Lt(distances, most));
    hn::StoreU(hn::Min(distances, most), d, &squares[n]);
  }
  return !hn::AllFalse(d, below);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raycone {
BlockKernel block_kernel(SimdLevel level) { return RAYCONE_AT_LEVEL(level, fill_block); }
RootKernel root_kernel(SimdLevel level) { return RAYCONE_AT_LEVEL(level, take_roots); }

}  // namespace raycone
#endif
