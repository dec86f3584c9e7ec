// Points where planes meet, and points of a tetrahedron.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "core/data/vec3.h"

namespace raycone {

struct PointOnPlane {
  Vec3 point;
  Vec3 normal;  // of length 1
};

// The point of all these planes that is nearest to `near`. None where it is farther than `tolerance` from one of them,
// or there are no planes. Planes whose normals differ by less than 1e-5 count as one.
[[nodiscard]] std::optional<Vec3> common_point(std::span<const PointOnPlane> planes, const Vec3& near,
                                               double tolerance);

// A tetrahedron whose points are told relative to its first corner.
class BarycentricCoordinates {
 public:
  // Precondition: it has a volume.
  explicit BarycentricCoordinates(const std::array<Vec3, 4>& corners);

  [[nodiscard]] const std::array<Vec3, 4>& corners() const { return corners_; }
  [[nodiscard]] std::array<double, 4> of(const Vec3& from_first) const {
    const double u = dot(from_first, across_[0]) / volume_, v = dot(from_first, across_[1]) / volume_,
                 w = dot(from_first, across_[2]) / volume_;
    return {1.0 - u - v - w, u, v, w};
  }

  // Whether the coordinates of a point are above `margin`.
  [[nodiscard]] bool is_within(const Vec3& from_first, double margin) const;

  // Moves a point into the tetrahedron: its coordinates are raised to `margin` where they are less, and scaled to add
  // up to 1.
  [[nodiscard]] Vec3 moved_within(const Vec3& from_first, double margin) const;

 private:
  std::array<Vec3, 4> corners_;
  std::array<Vec3, 3> across_;  // what grows with the distance from the faces opposite to the corners but the first
  double volume_;
};

}  // namespace raycone
