// Rays from points along +x, found by the triangles that they may cross.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "core/data/vec3.h"
#include "core/machine/sorted_by_key.h"

namespace raycone {

// A regular grid over the points' y and z. Nothing is built over triangles: going through many of them once is faster.
class RayGrid {
 public:
  // Precondition: they are finite. They must outlive this.
  explicit RayGrid(std::span<const Vec3> points);

  // Calls visit(i) for each point i, from x on, whose ray may meet the closed triangle: it lies in the shadow of its
  // box. Thread-safe.
  template <class Visit>
  void for_each_ray(const Vec3& a, const Vec3& b, const Vec3& c, double x, const Visit& visit) const {
    // Not of lists, whose loops branch as in a coin toss.
    const double y0 = std::min(std::min(a.y, b.y), c.y), y1 = std::max(std::max(a.y, b.y), c.y);
    const double z0 = std::min(std::min(a.z, b.z), c.z), z1 = std::max(std::max(a.z, b.z), c.z);
    if (y1 < lower_y_ || y0 > upper_y_ || z1 < lower_z_ || z0 > upper_z_) return;
    const double x1 = std::max(std::max(a.x, b.x), c.x);
    const std::size_t first_y = place(y0, lower_y_, per_y_), last_y = place(y1, lower_y_, per_y_);
    const std::size_t last_z = place(z1, lower_z_, per_z_);
    for (std::size_t z = place(z0, lower_z_, per_z_); z <= last_z; ++z) {
      // From one cell with points to the next: a large triangle is over many without.
      const std::size_t row_end = rays_.before(z * side_ + last_y + 1);
      for (std::size_t at = rays_.before(z * side_ + first_y); at != row_end;) {
        const std::size_t here = cell(points_[rays_.all()[at]]);
        for (const std::size_t i : from(x, here)) {
          const Vec3& q = points_[i];
          if (q.x > x1) break;
          if (q.y >= y0 && q.y <= y1 && q.z >= z0 && q.z <= z1) visit(i);
        }
        at = rays_.before(here + 1);
      }
    }
  }

 private:
  // The points of a cell from x on.
  [[nodiscard]] std::span<const std::size_t> from(double x, std::size_t cell) const {
    const std::span<const std::size_t> rays = rays_[cell];
    return {std::ranges::lower_bound(rays, x, {}, [this](std::size_t i) { return points_[i].x; }), rays.end()};
  }
  // Monotone in the coordinate: a point within an interval lies in a cell between those of its ends. By halves, whose
  // differences do not overflow.
  [[nodiscard]] std::size_t place(double coordinate, double lower, double per_half) const {
    const double cells = (coordinate / 2 - lower / 2) * per_half;
    return static_cast<std::size_t>(std::clamp(cells, 0.0, static_cast<double>(side_ - 1)));
  }
  [[nodiscard]] double cells_per_half(double lower, double upper) const;
  [[nodiscard]] std::size_t cell(const Vec3& p) const {
    return place(p.z, lower_z_, per_z_) * side_ + place(p.y, lower_y_, per_y_);
  }

  std::span<const Vec3> points_;
  double lower_y_, lower_z_, upper_y_, upper_z_;
  double per_y_ = 0.0, per_z_ = 0.0;  // cells per half of a unit
  std::size_t side_;
  SortedByKey<std::size_t> rays_;  // by cell; those of one by x
};

}  // namespace raycone
