// The distance from a point to a triangle.
#pragma once

#include <array>

#include "core/vec3.h"

namespace raycone {

// A triangle prepared for distances to many points. It may be degenerate: a segment or a point.
class TriangleDistance {
 public:
  TriangleDistance(const Vec3& a, const Vec3& b, const Vec3& c);

  // The square of the distance from p to the closed triangle, from its closest point. Coordinates below 2^500 in
  // magnitude. The distance is off by some units in the last place of itself and of the triangle's extent around p; of
  // a needle of angle s by some 1e-16 / s of its length, at most 1e-8.
  [[nodiscard]] double squared(const Vec3& p) const;

  // Whether the normal and what lies beyond which edge can be trusted: not a needle.
  [[nodiscard]] bool is_proper() const { return proper_; }

 private:
  // The square of the distance to the edge that starts at corner i.
  [[nodiscard]] double squared_to_edge(std::size_t i, const Vec3& p) const;

  std::array<Vec3, 3> corners_;
  std::array<Vec3, 3> edges_;             // edge i from corner i to the next
  std::array<double, 3> inverse_square_;  // of the edges' lengths; 0 for a point
  double ab_ab_, ab_ac_, ac_ac_;          // dot products of the edges from a
  double inverse_determinant_;            // of their matrix
  bool proper_;
};

}  // namespace raycone
