// Crossings of rays with many triangles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// Where a point lies with respect to faces.
struct RaySum {
  std::int64_t winding = 0;  // the sum of the signs of the triangles that the ray q + t x, t > 0, crosses
  bool on_surface = false;   // on a closed triangle
  bool is_near = false;      // or about as near to one as asked for
};

// For each point. Exact. No structure over the triangles is built: each looks for the rays that it may meet, so that
// the time is that of going through the triangles once, and of the crossings. Uses the threads that ThreadLimit allows;
// needs DefaultFloatingPoint.
// `near`: a distance from the plane of a triangle whose box, as much wider, holds the point; 0: nothing is near.
[[nodiscard]] std::vector<RaySum> ray_sums(const std::vector<Triangle>& faces, const std::vector<Vec3>& vertices,
                                           std::span<const Vec3> points, double near = 0.0);

}  // namespace raycone
