#include "core/evaluation/grid_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/evaluation/winding_number.h"

namespace raycone {
namespace {

constexpr std::uint64_t kGridEffort = 120;  // of building a grid, for each triangle: 0.4 to 0.8 us
constexpr std::uint64_t kPatience = 144;    // a little more, lest passes that were estimated to be cheaper be in vain
constexpr double kUsualDecisions = 4.0;     // for each ray

// Of many points, each triangle looks at a row or two of bins, which are in no cache, and some look at each ray.
double effort_of_passes(double points, double triangles, double decisions) {
  constexpr double kPointsOfPass = 65'536.0, kTriangle = 12.0, kLooks = 25.0;
  const double each = kLooks + PassEffort::kDecision * decisions;
  return kTriangle * std::ceil(points / kPointsOfPass) * triangles + each * points;
}

}  // namespace

bool grid_pays_for_points(double points, double triangles) {
  return effort_of_passes(points, triangles, kUsualDecisions) > kGridEffort * triangles;
}

double GridChoice::effort_of_passes(double points) const {
  const auto rays = static_cast<double>(rays_.load(std::memory_order_relaxed));
  const auto decisions = static_cast<double>(decisions_.load(std::memory_order_relaxed));
  return raycone::effort_of_passes(points, static_cast<double>(triangles_),
                                   rays > 0.0 ? decisions / rays : kUsualDecisions);
}

void GridChoice::count_effort(const PassEffort& effort) {
  decisions_.fetch_add(effort.decisions, std::memory_order_relaxed);
  effort_.fetch_add(effort.sum(), std::memory_order_relaxed);
}

std::uint64_t GridChoice::effort_left() const {
  if (is_ruled_out()) return std::numeric_limits<std::uint64_t>::max();
  const std::uint64_t most = kPatience * triangles_, spent = effort_.load(std::memory_order_relaxed);
  return spent < most ? most - spent : 0;
}

bool GridChoice::pays_for(double points) const {
  if (is_ruled_out()) return false;
  const auto passed = static_cast<double>(rays_.load(std::memory_order_relaxed));
  const double all = std::max(points, expected_points_.load(std::memory_order_relaxed) - passed);
  return effort_of_passes(all) > static_cast<double>(kGridEffort * triangles_) ||
         effort_of_passes(points) > static_cast<double>(effort_left());
}

std::size_t GridChoice::points_to_try(std::size_t points) const {
  constexpr std::size_t kFew = 1024;
  constexpr double kManyDecisions = 160.0;  // for each ray: twice what has been seen
  const double all = std::max(static_cast<double>(points), expected_points_.load(std::memory_order_relaxed));
  const bool is_sure = kManyDecisions * PassEffort::kDecision * all < static_cast<double>(kGridEffort * triangles_);
  return is_sure || is_ruled_out() || rays_.load(std::memory_order_relaxed) > 0 ? points : std::min(points, kFew);
}

}  // namespace raycone
