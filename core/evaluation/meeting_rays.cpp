#include "core/evaluation/meeting_rays.h"

#include <algorithm>
#include <numeric>

namespace raycone {

MeetingRays::MeetingRays(const ScaledMesh& mesh, std::span<const Vec3> points, std::size_t begin, std::size_t end)
    : buckets_(end - begin), indices_(end - begin) {
  for (std::size_t first = begin; first < end; first += kTile) {
    add(mesh, points.subspan(first, std::min(kTile, end - first)), static_cast<std::uint32_t>(first));
  }
  std::partial_sum(next_.begin(), next_.end(), next_.begin());
  ordered_.resize(count_);
  for (std::size_t i = 0; i < count_; ++i) ordered_[next_[buckets_[i]]++] = indices_[i];
}

void MeetingRays::add(const ScaledMesh& mesh, std::span<const Vec3> points, std::uint32_t first) {
  std::array<Vec3, kTile> queries;
  std::array<ProjectedGrid::Place, kTile> places;
  for (std::size_t i = 0; i < points.size(); ++i) queries[i] = mesh.to_scale(points[i]);
  mesh.grid().find_places({queries.data(), points.size()}, {places.data(), points.size()});
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint32_t index = first + static_cast<std::uint32_t>(i);
    const bool is_other = !mesh.can_take(points[i]);
    if (is_other) others_.push_back(index);
    const std::uint32_t is_next = places[i].may_meet && !is_other ? 1 : 0;
    const auto bucket = static_cast<std::uint8_t>(places[i].morton_code / kCodesPerBucket);
    buckets_[count_] = bucket;
    indices_[count_] = index;
    next_[bucket + std::size_t{1}] += is_next;
    count_ += is_next;
  }
}

}  // namespace raycone
