#include "core/crossings/binned_rays.h"

#include <cmath>
#include <numeric>

namespace raycone {

BinnedRays::Axis BinnedRays::axis_of(const std::vector<NumberedRay>& rays, int axis, std::size_t bins) {
  const auto [least, most] = std::ranges::minmax(rays, {}, [&](const NumberedRay& ray) { return ray.origin[axis]; });
  const double lower = least.origin[axis], upper = most.origin[axis];
  return {lower, upper, static_cast<double>(bins) / (upper - lower), lower < upper ? bins : 1};
}

BinnedRays::BinnedRays(std::vector<NumberedRay> rays) : begins_(2) {
  if (rays.empty()) return;
  constexpr double kLeast = 16, kMost = 1024;  // bins along an axis
  const double two_per_ray = 2.0 * std::sqrt(static_cast<double>(rays.size()));
  const auto bins = static_cast<std::size_t>(std::clamp(two_per_ray, kLeast, kMost));
  y_ = axis_of(rays, 1, bins);
  z_ = axis_of(rays, 2, bins);
  least_x_ = std::ranges::min_element(rays, {}, [](const NumberedRay& ray) { return ray.origin.x; })->origin.x;
  begins_.assign(y_.bins * z_.bins + 1, 0);
  for (const NumberedRay& ray : rays) ++begins_[bin_of(ray)];
  std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
  rays_.resize(rays.size());
  for (const NumberedRay& ray : rays) rays_[--begins_[bin_of(ray)]] = ray;
}

}  // namespace raycone
