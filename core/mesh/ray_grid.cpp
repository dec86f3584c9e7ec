#include "core/mesh/ray_grid.h"

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace raycone {

RayGrid::RayGrid(std::span<const Vec3> points) : points_(points) {
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
  per_y_ = cells_per_half(lower_y_, upper_y_);
  per_z_ = cells_per_half(lower_z_, upper_z_);
  std::vector<std::size_t> by_x(points.size());
  std::iota(by_x.begin(), by_x.end(), std::size_t{0});
  std::ranges::sort(by_x, {}, [points](std::size_t i) { return points[i].x; });
  rays_ = {side_ * side_, [&](const auto& emit) {
             for (const std::size_t i : by_x) emit(cell(points[i]), i);
           }};
}

double RayGrid::cells_per_half(double lower, double upper) const {
  const double cells = static_cast<double>(side_) / (upper / 2 - lower / 2);
  return std::isfinite(cells) ? cells : 0.0;
}

}  // namespace raycone
