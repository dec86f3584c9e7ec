#include "core/orientation/ray_sums.h"

#include <cmath>
#include <limits>
#include <mutex>

#include "core/crossings/crossings.h"
#include "core/data/box.h"
#include "core/machine/threads.h"
#include "core/mesh/ray_grid.h"

namespace raycone {
namespace {

// What a triangle does to a point.
struct RayHit {
  std::size_t point;
  int sigma;
  bool on_surface, is_near;
};

// Calls visit(i) for the points that are so near to the plane of a triangle, in its box.
template <class Visit>
void for_each_near(const RayGrid& grid, std::span<const Vec3> points, const Vec3& a, const Vec3& b, const Vec3& c,
                   double near, const Visit& visit) {
  const Box box = widened(box_of(a, b, c), near);
  const Vec3 normal = cross(b - a, c - a);
  const double most = near * norm(normal);
  grid.for_each_ray(box.lower, box.upper, box.upper, box.lower.x, [&](std::size_t i) {  // as of a flat triangle
    if (std::abs(dot(points[i] - a, normal)) <= most) visit(i);
  });
}

}  // namespace

std::vector<RaySum> ray_sums(const std::vector<Triangle>& faces, const std::vector<Vec3>& vertices,
                             std::span<const Vec3> points, double near) {
  std::vector<RaySum> sums(points.size());
  if (points.empty()) return sums;
  const RayGrid grid(points);
  std::mutex mutex;
  constexpr std::size_t kTrianglesPerTask = std::size_t{1} << 14;
  parallel_for(faces.size(), kTrianglesPerTask, [&](std::size_t begin, std::size_t end) {
    std::vector<RayHit> hits;
    for (std::size_t n = begin; n < end; ++n) {
      const Vec3 &a = vertices[faces[n][0]], &b = vertices[faces[n][1]], &c = vertices[faces[n][2]];
      grid.for_each_ray(a, b, c, -std::numeric_limits<double>::infinity(), [&](std::size_t i) {
        const QueryCrossing crossing = triangle_crossing(a, b, c, points[i]);
        if (crossing.sigma != 0 || crossing.on_surface) hits.push_back({i, crossing.sigma, crossing.on_surface, false});
      });
      if (near > 0.0) {
        for_each_near(grid, points, a, b, c, near, [&](std::size_t i) { hits.push_back({i, 0, false, true}); });
      }
    }
    const std::lock_guard<std::mutex> lock(mutex);
    for (const RayHit& hit : hits) {
      sums[hit.point].winding += hit.sigma;
      if (hit.on_surface) sums[hit.point].on_surface = true;
      if (hit.on_surface || hit.is_near) sums[hit.point].is_near = true;
    }
  });
  return sums;
}

}  // namespace raycone
