// Exact signs in the projection along a direction. Seen against it, the plane is oriented counter-clockwise.
//
// All of these hold for all finite doubles and are thread-safe; they need DefaultFloatingPoint. Directions are such as
// area_direction() returns.
#pragma once

#include <array>
#include <span>

#include "core/data/vec3.h"

namespace raycone {

// The direction of a polygon's area vector, the sum of c(i) x c(i+1), times a power of two: the largest component is
// between 1/2 and 2 in magnitude. Each component is the exact one, rounded with an error below 2^-30 of the sum of the
// components' magnitudes, nearly always far less. Zero if and only if the area vector is.
[[nodiscard]] Vec3 area_direction(std::span<const Vec3> corners);

// Sign of det(b - a, v, direction).
[[nodiscard]] int exact_side(const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& v);

// Sign of det(b - a, c - a, direction).
[[nodiscard]] int exact_turn(const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& c);

// A bound of what rounding does to the determinant in turn() and SweepOrder, as a part of its products' magnitudes
// added up: less than eight roundings of 2^-53. What underflows is below 2^-1060 times the direction, whose size is
// about 1.
inline constexpr double kTurnTrust = 0x1p-49;
inline constexpr double kTurnUnderflow = 0x1p-960;

// 1 where a, b, c turn left, -1 where they turn right, 0 where they lie on a line.
[[nodiscard]] inline int turn(const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 first = b - a, second = c - a;
  const double volume = dot(cross(first, second), direction);
  const double trust = kTurnTrust * dot(cross_terms(first, second), absolute(direction)) + kTurnUnderflow;
  if (volume > trust) return 1;
  if (volume < -trust) return -1;
  return exact_turn(direction, a, b, c);
}

// A lexicographic order of the projections: by the coordinate along one axis of the plane, then along another one, a
// quarter turn left of it. The two are askew to the axes of space: corners that are level with each other would take
// exact numbers to compare.
class SweepOrder {
 public:
  explicit SweepOrder(const Vec3& direction);

  // Negative where a comes before b, positive where it comes after, 0 where they project to one point.
  [[nodiscard]] int operator()(const Vec3& a, const Vec3& b) const {
    const int first = side(0, b, a);
    return first != 0 ? first : side(1, b, a);
  }

 private:
  // Sign of det(b - a, across_[axis], direction).
  [[nodiscard]] int side(std::size_t axis, const Vec3& a, const Vec3& b) const {
    const Vec3 step = b - a;
    const double value = dot(step, normal_[axis]);
    const double trust = kTurnTrust * dot(absolute(step), terms_[axis]) + kTurnUnderflow;
    if (value > trust) return 1;
    if (value < -trust) return -1;
    return exact_side(direction_, a, b, across_[axis]);
  }

  Vec3 direction_;
  std::array<Vec3, 2> across_, normal_, terms_;
};

}  // namespace raycone
