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
    const auto [a, b, c] = corners_of(*caps_, caps_->triangles[triangle]);
    n[i] += triangle_crossing(a, b, c, queries[i]).sigma;
  }
  return n;
}

}  // namespace raycone
