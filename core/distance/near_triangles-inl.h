// Which triangles may be nearest to some samples, by boxes and half-spaces (docs/method.md, "The nearest triangle").
// Included once per SIMD level.
#if defined(RAYCONE_CORE_NEAR_TRIANGLES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYCONE_CORE_NEAR_TRIANGLES_INL_H_
#undef RAYCONE_CORE_NEAR_TRIANGLES_INL_H_
#else
#define RAYCONE_CORE_NEAR_TRIANGLES_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "core/distance/block_kernel.h"
#include "core/distance/triangle_lanes-inl.h"
#include "core/machine/to_front-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

using Places = hn::RebindToSigned<Doubles>;

constexpr double kNowhere = std::numeric_limits<double>::infinity();

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
    list.distances[n] = 0.0;
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
  const auto of_corners = [&](std::size_t axis, const auto& choose) {
    const auto at = [&](std::size_t corner) { return hn::Load(d, &pack.corners[corner][axis][i]); };
    return choose(choose(at(0), at(1)), at(2));
  };
  const auto least = [](Lanes a, Lanes b) { return hn::Min(a, b); };
  const auto most = [](Lanes a, Lanes b) { return hn::Max(a, b); };
  return {{of_corners(0, least), of_corners(1, least), of_corners(2, least)},
          {of_corners(0, most), of_corners(1, most), of_corners(2, most)}};
}

// Where triangles are from the middle of some samples. Distances grow along `away`, of length 1. Where directions are
// not sure, they are 0, and distances are those from all samples at least.
struct Bearings {
  Lanes distances;
  VectorLanes away;
};

HWY_INLINE Bearings bearings_of(const NearTriangles& list, std::size_t n) {
  return {hn::LoadU(d, &list.distances[n]),
          {hn::LoadU(d, &list.away[0][n]), hn::LoadU(d, &list.away[1][n]), hn::LoadU(d, &list.away[2][n])}};
}

// Finds bearings from the middle of samples that are within `radius` of it.
class BearingFinder {
 public:
  BearingFinder(const Vec3& middle, double radius) : middle_(in_all_lanes(middle)), radius_(hn::Set(d, radius)) {}

  template <class Triangles>
  HWY_INLINE Bearings find(const Triangles& triangles, LaneMask wanted) {
    const Squares some = squared(triangles, middle_);
    const Lanes distances = hn::Sqrt(some.values), zero = hn::Zero(d);
    const Lanes direction_from = triangles(triangles.pack().direction_from);
    const LaneMask sure = hn::Ge(some.values, direction_from);
    const Lanes inverse = hn::Div(hn::Set(d, 1.0), distances);
    const VectorLanes away{hn::IfThenElseZero(sure, hn::Mul(inverse, some.rest.x)),
                           hn::IfThenElseZero(sure, hn::Mul(inverse, some.rest.y)),
                           hn::IfThenElseZero(sure, hn::Mul(inverse, some.rest.z))};
    if (hn::AllTrue(d, sure)) return {distances, away};
    const LaneMask unsure = hn::AndNot(sure, hn::And(wanted, hn::Ge(some.values, zero)));
    nearest_of_unsure_ = hn::IfThenElse(unsure, hn::Min(nearest_of_unsure_, distances), nearest_of_unsure_);
    const Lanes least = hn::Sqrt(hn::Max(least_with_care(some.values, direction_from), zero));
    return {hn::IfThenElse(sure, distances, hn::Max(hn::Sub(least, radius_), zero)), away};
  }

  // Of those that were wanted, but have no direction, the distance that the nearest has at most.
  [[nodiscard]] double nearest_of_unsure() const { return hn::GetLane(hn::MinOfLanes(d, nearest_of_unsure_)); }

 private:
  VectorLanes middle_;
  Lanes radius_, nearest_of_unsure_ = hn::Set(d, kNowhere);
};

HWY_INLINE void append(NearTriangles& list, const BoxLanes& boxes, const Bearings& bearings, hn::Vec<Places> places,
                       LaneMask wanted) {
  const std::size_t at = list.count;
  const ToFront<Doubles> front(wanted);
  const auto store = [&](auto tag, auto lanes, auto* to) { hn::StoreU(front(tag, lanes), tag, to); };  // whole vectors
  store(d, bearings.distances, &list.distances[at]);
  store(d, bearings.away.x, &list.away[0][at]);
  store(d, bearings.away.y, &list.away[1][at]);
  store(d, bearings.away.z, &list.away[2][at]);
  store(d, boxes.lower.x, &list.lower[0][at]);
  store(d, boxes.lower.y, &list.lower[1][at]);
  store(d, boxes.lower.z, &list.lower[2][at]);
  store(d, boxes.upper.x, &list.upper[0][at]);
  store(d, boxes.upper.y, &list.upper[1][at]);
  store(d, boxes.upper.z, &list.upper[2][at]);
  store(Places(), places, &list.places[at]);
  list.count += hn::CountTrue(d, wanted);
}

// The samples of a box from its middle.
struct Middle {
  VectorLanes lower, upper;  // of the box that the samples span
  Vec3 center;
  double radius;
  Vec3 extent;  // from there along each axis

  Middle(const LatticeRows& rows, const SampleBox& box) {
    const auto [first, last] = rows.box_of(box);
    lower = in_all_lanes(first);
    upper = in_all_lanes(last);
    center = 0.5 * (first + last);
    const Vec3 from_first = center - first, to_last = last - center;
    extent = {std::max(from_first.x, to_last.x), std::max(from_first.y, to_last.y), std::max(from_first.z, to_last.z)};
    radius = std::sqrt(raycone::dot(extent, extent));
  }
};

double square_of_reach(double reach) { return beyond_error(reach * kReachSlack * (reach * kReachSlack)); }

// The triangles of packs that are near the block; their bearings from its middle where these are wanted.
void find_near(const BlockTask& task, const Middle& middle, bool with_bearings, NearTriangles& near) {
  BearingFinder finder(middle.center, middle.radius);
  const Lanes from_box = hn::Set(d, square_of_reach(task.reach));
  Bearings bearings{hn::Zero(d), in_all_lanes({})};
  make_room(near, task.packs.size() * kWidth);
  for (const std::uint32_t number : task.packs) {
    const TrianglePack& pack = task.tree.packs()[number];
    for (std::size_t i = 0; i < kWidth; i += hn::Lanes(d)) {
      const BoxLanes boxes = boxes_of(pack, i);
      const LaneMask wanted = hn::Lt(squared_between(boxes.lower, boxes.upper, middle.lower, middle.upper), from_box);
      if (hn::AllFalse(d, wanted)) continue;
      if (with_bearings) bearings = finder.find(PackedTriangles(pack, i), wanted);
      const Places integers;
      append(near, boxes, bearings, hn::Iota(integers, static_cast<std::int64_t>(number * kWidth + i)), wanted);
    }
  }
  near.nearest_of_unsure = finder.nearest_of_unsure();
}

// Puts copies of the triangles side by side, so that many looks at them take no gathering. Places are then those in
// `packs`.
void pack_together(const DistanceTree& tree, NearTriangles& near, std::vector<TrianglePack>& packs) {
  const std::size_t count = (near.count + kWidth - 1) / kWidth;
  if (packs.size() < count) packs.resize(count);
  for (std::size_t n = 0; n < near.count; ++n) {
    const auto place = static_cast<std::size_t>(near.places[n]);
    packs[n / kWidth].copy(n % kWidth, tree.packs()[place / kWidth], place % kWidth);
    near.places[n] = static_cast<std::int64_t>(n);
  }
}

// Of `all`, which are those of `packs` in their order, the ones within reach of the samples, with bearings from the
// middle. Neighbours in packs are neighbours in space: mostly all of some lanes are out of reach.
void find_in_reach(const BlockTask& task, const Middle& middle, const std::vector<TrianglePack>& packs,
                   const NearTriangles& all, NearTriangles& found) {
  BearingFinder finder(middle.center, middle.radius);
  const Lanes from_box = hn::Set(d, square_of_reach(task.reach));
  const Places integers;
  make_room(found, all.count);
  for (std::size_t n = 0; n < all.count; n += hn::Lanes(d)) {
    const BoxLanes boxes = boxes_of(all, n);
    const LaneMask wanted = hn::Lt(squared_between(boxes.lower, boxes.upper, middle.lower, middle.upper), from_box);
    if (hn::AllFalse(d, wanted)) continue;
    const Bearings bearings = finder.find(PackedTriangles(packs[n / kWidth], n % kWidth), wanted);
    append(found, boxes, bearings, hn::LoadU(integers, &all.places[n]), wanted);
  }
  found.nearest_of_unsure = finder.nearest_of_unsure();
}

struct Bearing {
  double distance;
  Vec3 away;
};

// That of the nearest triangle with a direction; else an infinite distance.
Bearing nearest_of(const NearTriangles& near) {
  const bool all_sure = near.nearest_of_unsure == kNowhere;
  Lanes least = hn::Set(d, kNowhere), number = hn::Zero(d);
  for (std::size_t n = 0; n < near.count; n += hn::Lanes(d)) {
    const Lanes distances = hn::LoadU(d, &near.distances[n]);
    LaneMask known = hn::And(hn::FirstN(d, near.count - n), hn::Gt(distances, hn::Zero(d)));
    if (!all_sure) {
      const VectorLanes away = bearings_of(near, n).away;
      known = hn::And(known, hn::Gt(dot(away, away), hn::Zero(d)));
    }
    const LaneMask nearer = hn::And(known, hn::Lt(distances, least));
    least = hn::IfThenElse(nearer, distances, least);
    number = hn::IfThenElse(nearer, hn::Iota(d, static_cast<double>(n)), number);
  }
  const double distance = hn::GetLane(hn::MinOfLanes(d, least));
  if (distance == kNowhere) return {kNowhere, {}};
  const LaneMask is_least = hn::Eq(least, hn::Set(d, distance));
  const auto n =
      static_cast<std::size_t>(hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(is_least, number, hn::Set(d, kNowhere)))));
  return {distance, {near.away[0][n], near.away[1][n], near.away[2][n]}};
}

// How much farther than by its direction a triangle at this distance gets within the radius at most.
double bend(double distance, double radius) {
  return distance > radius / 2 ? radius * radius / (2 * distance) : 2 * (radius - distance);
}

// More than distances within `radius` of the middle, of about `distance`, are off by, and more than directions are off
// whose distance is sure.
double slack_of(double distance, double radius) { return 1e-5 * radius + 1e-8 * distance + 1e-14; }

// What samples are within of the nearest triangle, and along `away` by as much more as they are ahead.
Bearing farthest_from_nearest(const Middle& middle, const NearTriangles& near) {
  const Bearing nearest = nearest_of(near);
  const double within = nearest.distance + bend(nearest.distance, middle.radius);
  if (!(within < near.nearest_of_unsure + middle.radius)) return {near.nearest_of_unsure + middle.radius, {}};
  return {within, nearest.away};
}

// Of triangles with bearings from the middle of some samples, those stay that may be nearest to one of these.
void keep_nearest(const Middle& middle, NearTriangles& near) {
  const Bearing nearest = farthest_from_nearest(middle, near);
  const Lanes within = hn::Set(d, nearest.distance + slack_of(nearest.distance, middle.radius));
  const VectorLanes away = in_all_lanes(nearest.away);
  const Places integers;
  const std::size_t count = std::exchange(near.count, 0);
  for (std::size_t n = 0; n < count; n += hn::Lanes(d)) {
    const Bearings bearings = bearings_of(near, n);
    const VectorLanes turn = minus(away, bearings.away);
    const Lanes gained = dot({hn::Abs(turn.x), hn::Abs(turn.y), hn::Abs(turn.z)}, in_all_lanes(middle.extent));
    const LaneMask wanted = hn::And(hn::FirstN(d, count - n), hn::Le(bearings.distances, hn::Add(within, gained)));
    if (hn::AllFalse(d, wanted)) continue;
    append(near, boxes_of(near, n), bearings, hn::LoadU(integers, &near.places[n]),
           wanted);  // behind none that is left
  }
  close(near);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#endif
