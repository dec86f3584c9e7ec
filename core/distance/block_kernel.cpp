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

#include "core/distance/triangle_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();
constexpr double kSlack = 1 + 1e-9;  // more than roundings of sums take; beyond_error() adds those of distances
constexpr std::size_t kWidth = TrianglePack::kWidth;
constexpr std::size_t kPartSide = 4, kGroupSide = 2;
constexpr std::size_t kGroup = 8;  // samples
using Places = hn::RebindToSigned<Doubles>;

// Whatever is compressed into a list may write this far beyond its end.
void make_room(NearTriangles& list, std::size_t count) {
  list.count = 0;
  if (list.places.size() >= count + kWidth) return;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (auto* const column : {&list.lower[axis], &list.upper[axis], &list.away[axis]}) column->resize(count + kWidth);
  }
  list.distances.resize(count + kWidth);
  list.places.resize(count + kWidth);
}

// Triangles beyond the last one, for the last lanes: they are too far away to be near anything.
void close(NearTriangles& list) {
  constexpr double kFarAway = 1e300;
  for (std::size_t n = list.count; n < list.count + kWidth; ++n) {
    for (std::size_t axis = 0; axis < 3; ++axis) list.lower[axis][n] = list.upper[axis][n] = kFarAway;
    list.places[n] = 0;
  }
}

struct BoxLanes {
  VectorLanes lower, upper;
};

HWY_INLINE BoxLanes boxes_of(const NearTriangles& list, std::size_t n) {
  return {{hn::LoadU(d, &list.lower[0][n]), hn::LoadU(d, &list.lower[1][n]), hn::LoadU(d, &list.lower[2][n])},
          {hn::LoadU(d, &list.upper[0][n]), hn::LoadU(d, &list.upper[1][n]), hn::LoadU(d, &list.upper[2][n])}};
}
HWY_INLINE BoxLanes boxes_of(const TrianglePack& pack, std::size_t i) {
  return {{hn::Load(d, &pack.lower[0][i]), hn::Load(d, &pack.lower[1][i]), hn::Load(d, &pack.lower[2][i])},
          {hn::Load(d, &pack.upper[0][i]), hn::Load(d, &pack.upper[1][i]), hn::Load(d, &pack.upper[2][i])}};
}

HWY_INLINE void append(NearTriangles& list, const BoxLanes& boxes, hn::Vec<Places> places, LaneMask wanted) {
  const std::size_t at = list.count;
  hn::CompressStore(boxes.lower.x, wanted, d, &list.lower[0][at]);
  hn::CompressStore(boxes.lower.y, wanted, d, &list.lower[1][at]);
  hn::CompressStore(boxes.lower.z, wanted, d, &list.lower[2][at]);
  hn::CompressStore(boxes.upper.x, wanted, d, &list.upper[0][at]);
  hn::CompressStore(boxes.upper.y, wanted, d, &list.upper[1][at]);
  hn::CompressStore(boxes.upper.z, wanted, d, &list.upper[2][at]);
  const Places integers;
  list.count += hn::CompressStore(places, hn::RebindMask(integers, wanted), integers, &list.places[at]);
}

// The samples of a box from its middle.
struct Middle {
  VectorLanes lower, upper;  // of the box that the samples span
  Vec3 center;
  double radius;
  VectorLanes extent;  // from there along each axis

  Middle(const LatticeRows& rows, const SampleBox& box) {
    const Vec3 first{rows.xs[box.begin[0]], rows.ys[box.begin[1]], rows.zs[box.begin[2]]};
    const Vec3 last{rows.xs[box.end[0] - 1], rows.ys[box.end[1] - 1], rows.zs[box.end[2] - 1]};
    lower = in_all_lanes(first);
    upper = in_all_lanes(last);
    center = 0.5 * (first + last);
    const Vec3 from_first = center - first, to_last = last - center;
    const Vec3 farthest{std::max(from_first.x, to_last.x), std::max(from_first.y, to_last.y),
                        std::max(from_first.z, to_last.z)};
    radius = std::sqrt(raycone::dot(farthest, farthest));
    extent = in_all_lanes(farthest);
  }
};

double square_of_reach(double reach) { return beyond_error(reach * kSlack * (reach * kSlack)); }

// The triangles of packs that are near the block.
void find_near(const BlockTask& task, NearTriangles& near) {
  const Middle middle(task.rows, task.block);
  const VectorLanes center = in_all_lanes(task.center);
  const Lanes from_box = hn::Set(d, square_of_reach(task.reach));
  const Lanes from_center = hn::Set(d, square_of_reach(task.reach + task.radius));
  make_room(near, task.packs.size() * kWidth);
  for (const std::uint32_t number : task.packs) {
    const TrianglePack& pack = task.tree.packs()[number];
    for (std::size_t i = 0; i < kWidth; i += hn::Lanes(d)) {
      const BoxLanes boxes = boxes_of(pack, i);
      LaneMask wanted = hn::Lt(squared_between(boxes.lower, boxes.upper, middle.lower, middle.upper), from_box);
      if (hn::AllFalse(d, wanted)) continue;
      const Squares from_middle = squared(PackedTriangles(pack, i), center);
      wanted = hn::AndNot(hn::AndNot(hn::Le(from_middle.values, from_center), from_middle.sure), wanted);
      const Places integers;
      append(near, boxes, hn::Iota(integers, static_cast<std::int64_t>(number * kWidth + i)), wanted);
    }
  }
  close(near);
}

// Triangles at some places of the packs.
class PlacedTriangles {
 public:
  PlacedTriangles(const DistanceTree& tree, hn::Vec<Places> places) : pack_(tree.packs().front()) {
    constexpr auto kStride = static_cast<std::int64_t>(sizeof(TrianglePack) / sizeof(double));
    const Places integers;
    const auto numbers = hn::ShiftRight<3>(places);
    const auto slots = hn::And(places, hn::Set(integers, 7));
    alignas(64) std::array<std::int64_t, kWidth> number;
    hn::Store(numbers, integers, number.data());
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) number[lane] *= kStride;
    offsets_ = hn::Add(hn::Load(integers, number.data()), slots);
  }
  HWY_INLINE Lanes operator()(const TrianglePack::Column& column) const {
    return hn::GatherIndex(d, column.data(), offsets_);
  }
  HWY_INLINE const TrianglePack& pack() const { return pack_; }

 private:
  const TrianglePack& pack_;
  hn::Vec<Places> offsets_;
};

// Where a triangle is from the middle of some samples.
struct Bearing {
  double distance;
  Vec3 away;  // of length 1, or 0 where the distance is not sure
};

// Sets the distances of the triangles from p, and returns what of the nearest one is known. A distance that is not sure
// is not less than the triangle's.
Bearing take_bearings(const Vec3& p, const DistanceTree& tree, NearTriangles& near) {
  const VectorLanes ps = in_all_lanes(p);
  const Places integers;
  Lanes least = hn::Set(d, kNowhere), number = hn::Zero(d);
  for (std::size_t n = 0; n < near.count; n += hn::Lanes(d)) {
    const Squares some = squared(PlacedTriangles(tree, hn::LoadU(integers, &near.places[n])), ps);
    const Lanes distances = hn::Sqrt(some.values);
    const LaneMask sure = hn::And(some.sure, hn::Gt(distances, hn::Zero(d)));
    const VectorLanes away = times(hn::Div(hn::Set(d, 1.0), distances), some.rest);
    hn::StoreU(hn::IfThenElseZero(sure, distances), d, &near.distances[n]);
    hn::StoreU(hn::IfThenElseZero(sure, away.x), d, &near.away[0][n]);
    hn::StoreU(hn::IfThenElseZero(sure, away.y), d, &near.away[1][n]);
    hn::StoreU(hn::IfThenElseZero(sure, away.z), d, &near.away[2][n]);
    const Lanes numbers = hn::Iota(d, static_cast<double>(n));
    const LaneMask nearer =
        hn::And(hn::Lt(distances, least), hn::Lt(numbers, hn::Set(d, static_cast<double>(near.count))));
    least = hn::IfThenElse(nearer, distances, least);
    number = hn::IfThenElse(nearer, numbers, number);
  }
  const Lanes nearest = hn::MinOfLanes(d, least);
  const Lanes candidates = hn::IfThenElse(hn::Eq(least, nearest), number, hn::Set(d, kNowhere));
  const auto n = static_cast<std::size_t>(hn::GetLane(hn::MinOfLanes(d, candidates)));
  return {hn::GetLane(nearest), {near.away[0][n], near.away[1][n], near.away[2][n]}};
}

// How much farther than by its direction a triangle at this distance gets within the radius at most.
double bend(double distance, double radius) {
  return distance > radius / 2 ? radius * radius / (2 * distance) : 2 * (radius - distance);
}

// Of the triangles near more samples, those that may be nearest to one of `box`, as far as `reach`.
void narrow(const BlockTask& task, const SampleBox& box, double reach, NearTriangles& near, NearTriangles& fewer) {
  const Middle middle(task.rows, box);
  const Bearing nearest = take_bearings(middle.center, task.tree, near);
  const bool has_direction = nearest.away != Vec3{};
  // More than distances are off by, and directions of which the distance is sure.
  const double slack = 1e-5 * middle.radius + 1e-8 * nearest.distance + 1e-14;
  const double within = has_direction ? nearest.distance + bend(nearest.distance, middle.radius) + slack
                                      : nearest.distance + 2 * middle.radius + slack;
  const VectorLanes away = in_all_lanes(nearest.away), extent = middle.extent;
  const Lanes from_box = hn::Set(d, square_of_reach(reach));
  const Places integers;
  make_room(fewer, near.count);
  for (std::size_t n = 0; n < near.count; n += hn::Lanes(d)) {
    const BoxLanes boxes = boxes_of(near, n);
    const VectorLanes turn =
        minus(away, {hn::LoadU(d, &near.away[0][n]), hn::LoadU(d, &near.away[1][n]), hn::LoadU(d, &near.away[2][n])});
    const Lanes gained = hn::Add(hn::Add(hn::Mul(hn::Abs(turn.x), extent.x), hn::Mul(hn::Abs(turn.y), extent.y)),
                                 hn::Mul(hn::Abs(turn.z), extent.z));
    const Lanes most = hn::Add(hn::Set(d, within), has_direction ? gained : hn::Zero(d));
    const LaneMask wanted =
        hn::And(hn::Lt(squared_between(boxes.lower, boxes.upper, middle.lower, middle.upper), from_box),
                hn::Le(hn::LoadU(d, &near.distances[n]), most));
    append(fewer, boxes, hn::LoadU(integers, &near.places[n]), wanted);
  }
  close(fewer);
}

// Eight samples; the last ones are repeated where there are fewer.
struct Group {
  alignas(64) std::array<double, kGroup> x, y, z, least;
  std::array<std::size_t, kGroup> index;  // in BlockTask::squares

  Group(const BlockTask& task, const SampleBox& box) {
    const LatticeRows& rows = task.rows;
    for (std::size_t n = 0; n < kGroup; ++n) {
      const std::size_t i = std::min(box.begin[0] + n % 2, box.end[0] - 1);
      const std::size_t j = std::min(box.begin[1] + n / 2 % 2, box.end[1] - 1);
      const std::size_t k = std::min(box.begin[2] + n / 4, box.end[2] - 1);
      x[n] = rows.xs[i];
      y[n] = rows.ys[j];
      z[n] = rows.zs[k];
      index[n] = (k * rows.ys.size() + j) * rows.xs.size() + i;
    }
    least.fill(kNowhere);
  }
};

// Samples for which lanes are not sure.
void take_care(const TrianglePack& pack, std::size_t slot, std::size_t first, LaneMask sure, Group& group) {
  alignas(64) std::array<double, kWidth> is_sure;
  hn::Store(hn::IfThenElseZero(sure, hn::Set(d, 1.0)), d, is_sure.data());
  const TriangleDistance triangle = pack.triangle(slot);
  for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
    if (is_sure[lane] != 0.0) continue;
    const std::size_t n = first + lane;
    group.least[n] = std::min(group.least[n], triangle.squared({group.x[n], group.y[n], group.z[n]}));
  }
}

HWY_INLINE void lower_to(const TrianglePack& pack, std::size_t slot, Group& group) {
  for (std::size_t n = 0; n < kGroup; n += hn::Lanes(d)) {
    const VectorLanes ps{hn::Load(d, &group.x[n]), hn::Load(d, &group.y[n]), hn::Load(d, &group.z[n])};
    const Squares some = squared(SameTriangle(pack, slot), ps);
    const Lanes before = hn::Load(d, &group.least[n]);
    hn::Store(hn::IfThenElse(some.sure, hn::Min(before, some.values), before), d, &group.least[n]);
    if (!hn::AllTrue(d, some.sure)) take_care(pack, slot, n, some.sure, group);
  }
}

void fill_group(const BlockTask& task, const SampleBox& box, const NearTriangles& near) {
  Group group(task, box);
  for (std::size_t n = 0; n < near.count; ++n) {
    const auto place = static_cast<std::size_t>(near.places[n]);
    lower_to(task.tree.packs()[place / kWidth], place % kWidth, group);
  }
  for (std::size_t n = 0; n < kGroup; ++n) {
    double& square = task.squares[group.index[n]];
    square = std::min(square, group.least[n]);
  }
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

void fill_block(const BlockTask& task, BlockScratch& scratch) {
  find_near(task, scratch.of_block);
  for_each_part(task.block, kPartSide, [&](const SampleBox& part) {
    if (scratch.of_block.count == 0) return;
    narrow(task, part, task.reach, scratch.of_block, scratch.of_part);
    for_each_part(part, kGroupSide, [&](const SampleBox& box) {
      if (scratch.of_part.count == 0) return;
      narrow(task, box, task.reach, scratch.of_part, scratch.of_group);
      if (scratch.of_group.count > 0) fill_group(task, box, scratch.of_group);
    });
  });
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raycone {

BlockKernel block_kernel([[maybe_unused]] SimdLevel level) {
#if HWY_ARCH_X86
  const SimdLevel available = available_level(level);
  if (available == SimdLevel::kAvx512) return HWY_CHOOSE_AVX3(fill_block);
  if (available == SimdLevel::kAvx2) return HWY_CHOOSE_AVX2(fill_block);
  if (available == SimdLevel::kSse4) return HWY_CHOOSE_SSE4(fill_block);
#endif
  return &HWY_STATIC_DISPATCH(fill_block);
}

}  // namespace raycone
#endif
