#include "core/far/cap_crossings.h"

#include <vector>

#include "core/crossings/crossings.h"

namespace raycone {

std::array<std::int64_t, kTile> CapCrossings::of(const SampleTile& samples) const {
  std::array<std::int64_t, kTile> n{};
  if (!grid_) return n;
  std::array<Vec3, kTile> queries;
  for (std::size_t i = 0; i < samples.count; ++i) queries[i] = samples.query(i);
  std::vector<RayCandidate> doubtful;
  grid_->crossings({queries.data(), samples.count}, {n.data(), samples.count}, doubtful);
  for (const auto& [i, triangle] : doubtful) {
    const Triangle& t = caps_->triangles[triangle];
    const Vec3 &a = caps_->vertices[t[0]], &b = caps_->vertices[t[1]], &c = caps_->vertices[t[2]], &q = queries[i];
    const TriangleCrossing crossing = triangle_crossing(a, b, c, {q.y, q.z, {&q.x, 1}}, nullptr);
    if (crossing.crossed > 0) n[i] += crossing.sigma;
  }
  return n;
}

}  // namespace raycone
