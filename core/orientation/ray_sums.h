// Crossings of few rays with many triangles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// For each point q the sum of the signs of the triangles that the ray q + t x, t > 0, crosses. Exact. No structure over
// the triangles is built: each looks for the rays that it may meet, so that the time is that of going through the
// triangles once. Uses the threads that ThreadLimit allows; needs DefaultFloatingPoint.
[[nodiscard]] std::vector<std::int64_t> ray_sums(const TriangleMesh& mesh, std::span<const Vec3> points);

}  // namespace raycone
