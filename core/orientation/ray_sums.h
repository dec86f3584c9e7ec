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
  bool is_near = false;      // on or near a triangle, within rounding
};

// For each point. Windings and `on_surface` are exact. No structure over the triangles is built: each triangle looks
// for the rays that it may meet, so that the time is that of going through the triangles once, and of the crossings.
// Uses the threads that ThreadLimit allows; needs DefaultFloatingPoint.
// `near`: a point is near a triangle if it is no farther than that from the triangle's plane, and in its box widened by
// as much. With 0 no point is near but on the surface.
[[nodiscard]] std::vector<RaySum> ray_sums(const std::vector<Triangle>& faces, const std::vector<Vec3>& vertices,
                                           std::span<const Vec3> points, double near = 0.0);

}  // namespace raycone
