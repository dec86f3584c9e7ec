#include "core/cells/planes_point.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace raycone {
namespace {

// The part of v across the axis, which has length 1.
Vec3 across(const Vec3& v, const Vec3& axis) { return v - dot(v, axis) * axis; }

Vec3 of_length_1(const Vec3& v) { return (1.0 / std::sqrt(dot(v, v))) * v; }

// Takes up to three planes that are as independent as possible, one by one: the remaining ones' normals are made
// perpendicular to those taken (Gram-Schmidt with pivots), and the point moves along these directions onto each plane.
Vec3 moved_onto(std::span<const PointOnPlane> planes, Vec3 point) {
  constexpr double kIndependent = 1e-5;
  std::array<Vec3, 3> taken;
  for (std::size_t rank = 0; rank < taken.size(); ++rank) {
    const PointOnPlane* best = nullptr;
    Vec3 best_direction;
    for (const PointOnPlane& plane : planes) {
      Vec3 direction = plane.normal;
      for (std::size_t i = 0; i < rank; ++i) direction = across(direction, taken[i]);
      if (!best || dot(direction, direction) > dot(best_direction, best_direction)) {
        best = &plane;
        best_direction = direction;
      }
    }
    if (!best || !(dot(best_direction, best_direction) > kIndependent * kIndependent)) break;
    const Vec3 along = of_length_1(best_direction);
    point = point + (dot(best->normal, best->point - point) / dot(best->normal, along)) * along;
    taken[rank] = along;
  }
  return point;
}

}  // namespace

BarycentricCoordinates::BarycentricCoordinates(const std::array<Vec3, 4>& corners) : corners_(corners) {
  const Vec3 a = corners[1] - corners[0], b = corners[2] - corners[0], c = corners[3] - corners[0];
  across_ = {cross(b, c), cross(c, a), cross(a, b)};
  volume_ = dot(a, across_[0]);
}

std::optional<Vec3> common_point(std::span<const PointOnPlane> planes, const Vec3& near, double tolerance) {
  if (planes.empty()) return std::nullopt;
  // A second pass takes away what the first one rounds.
  const Vec3 point = moved_onto(planes, moved_onto(planes, near));
  const bool on_all = std::ranges::all_of(
      planes, [&](const PointOnPlane& plane) { return std::abs(dot(plane.normal, point - plane.point)) <= tolerance; });
  return on_all ? std::optional(point) : std::nullopt;
}

bool BarycentricCoordinates::is_within(const Vec3& from_first, double margin) const {
  return std::ranges::all_of(of(from_first), [&](double weight) { return weight > margin; });
}

Vec3 BarycentricCoordinates::moved_within(const Vec3& from_first, double margin) const {
  std::array<double, 4> weights = of(from_first);
  double sum = 0.0;
  for (double& weight : weights) {
    weight = std::max(weight, margin);
    sum += weight;
  }
  Vec3 moved;
  for (std::size_t i = 1; i < corners_.size(); ++i) moved = moved + (weights[i] / sum) * (corners_[i] - corners_[0]);
  return moved;
}

}  // namespace raycone
