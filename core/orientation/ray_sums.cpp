#include "core/orientation/ray_sums.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "core/crossings/crossings.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// A regular grid over the points' y and z.
class RayGrid {
 public:
  explicit RayGrid(std::span<const Vec3> points) : points_(points) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    lower_y_ = lower_z_ = kInfinity;
    upper_y_ = upper_z_ = -kInfinity;
    for (const Vec3& p : points) {
      lower_y_ = std::min(lower_y_, p.y);
      lower_z_ = std::min(lower_z_, p.z);
      upper_y_ = std::max(upper_y_, p.y);
      upper_z_ = std::max(upper_z_, p.z);
    }
    constexpr double kMostCells = 1024;
    side_ = static_cast<std::size_t>(std::clamp(2.0 * std::sqrt(static_cast<double>(points.size())), 1.0, kMostCells));
    per_y_ = cells_per_unit(lower_y_, upper_y_);
    per_z_ = cells_per_unit(lower_z_, upper_z_);
    begin_.assign(side_ * side_ + 1, 0);
    for (const Vec3& p : points) ++begin_[cell(p) + 1];
    for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    rays_.resize(points.size());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t i = 0; i < points.size(); ++i) rays_[next[cell(points[i])]++] = i;
  }

  // Calls visit(i) for each point i whose ray may meet the box of the triangle.
  template <class Visit>
  void for_each_ray(const Vec3& a, const Vec3& b, const Vec3& c, const Visit& visit) const {
    // Not of lists, whose loops branch as in a coin toss.
    const double y0 = std::min(std::min(a.y, b.y), c.y), y1 = std::max(std::max(a.y, b.y), c.y);
    const double z0 = std::min(std::min(a.z, b.z), c.z), z1 = std::max(std::max(a.z, b.z), c.z);
    if (y1 < lower_y_ || y0 > upper_y_ || z1 < lower_z_ || z0 > upper_z_) return;
    const double x1 = std::max(std::max(a.x, b.x), c.x);
    const std::size_t last_y = place(y1 - lower_y_, per_y_), last_z = place(z1 - lower_z_, per_z_);
    for (std::size_t z = place(z0 - lower_z_, per_z_); z <= last_z; ++z) {
      for (std::size_t y = place(y0 - lower_y_, per_y_); y <= last_y; ++y) {
        for (std::size_t i = begin_[z * side_ + y]; i < begin_[z * side_ + y + 1]; ++i) {
          const Vec3& q = points_[rays_[i]];
          if (q.x <= x1 && q.y >= y0 && q.y <= y1 && q.z >= z0 && q.z <= z1) visit(rays_[i]);
        }
      }
    }
  }

 private:
  // Monotone in the coordinate: a point within an interval lies in a cell between those of its ends.
  [[nodiscard]] std::size_t place(double offset, double per_unit) const {
    return static_cast<std::size_t>(std::clamp(offset * per_unit, 0.0, static_cast<double>(side_ - 1)));
  }
  [[nodiscard]] double cells_per_unit(double lower, double upper) const {
    const double cells = static_cast<double>(side_) / (upper - lower);
    return std::isfinite(cells) ? cells : 0.0;
  }
  [[nodiscard]] std::size_t cell(const Vec3& p) const {
    return place(p.z - lower_z_, per_z_) * side_ + place(p.y - lower_y_, per_y_);
  }

  std::span<const Vec3> points_;
  double lower_y_, lower_z_, upper_y_, upper_z_, per_y_ = 0.0, per_z_ = 0.0;
  std::size_t side_;
  std::vector<std::size_t> begin_;  // per cell, and the end
  std::vector<std::size_t> rays_;   // by cell
};

// What a triangle does to a point.
struct RayHit {
  std::size_t point;
  int sigma;
  bool on_surface;
};

}  // namespace

std::vector<RaySum> ray_sums(const std::vector<Triangle>& faces, const std::vector<Vec3>& vertices,
                             std::span<const Vec3> points) {
  std::vector<RaySum> sums(points.size());
  if (points.empty()) return sums;
  const RayGrid grid(points);
  std::mutex mutex;
  constexpr std::size_t kTrianglesPerTask = std::size_t{1} << 14;
  parallel_for(faces.size(), kTrianglesPerTask, [&](std::size_t begin, std::size_t end) {
    std::vector<RayHit> hits;
    for (std::size_t n = begin; n < end; ++n) {
      const Vec3 &a = vertices[faces[n][0]], &b = vertices[faces[n][1]], &c = vertices[faces[n][2]];
      grid.for_each_ray(a, b, c, [&](std::size_t i) {
        const Vec3& q = points[i];
        const TriangleCrossing crossing = triangle_crossing(a, b, c, {q.y, q.z, {&q.x, 1}, 0.0}, nullptr);
        const bool on_surface = crossing.on_begin < crossing.on_end;
        if (crossing.crossed > 0 || on_surface)
          hits.push_back({i, crossing.crossed > 0 ? crossing.sigma : 0, on_surface});
      });
    }
    const std::lock_guard<std::mutex> lock(mutex);
    for (const RayHit& hit : hits) {
      sums[hit.point].winding += hit.sigma;
      if (hit.on_surface) sums[hit.point].on_surface = true;
    }
  });
  return sums;
}

}  // namespace raycone
