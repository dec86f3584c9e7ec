// The distance from a point to a triangle where doubles do not do.
#pragma once

#include <array>
#include <cstddef>

#include "core/data/vec3.h"
#include "core/exact/double_double.h"

namespace raycone {

[[nodiscard]] inline double square(const Vec3& v) { return dot(v, v); }

// A triangle, which may be degenerate, prepared for accurate distances to points.
class AccurateTriangle {
 public:
  AccurateTriangle(const Vec3& a, const Vec3& b, const Vec3& c);

  // The square of the distance from p to the closed triangle: that distance is off by less than 1e-15 of itself or
  // 1e-16 of the largest coordinate, which is 1/2 or more (docs/method.md, "Distances"). Coordinates below 2^400 in
  // magnitude. Costs some tenths of a microsecond.
  [[nodiscard]] double squared_distance(const Vec3& p) const;

 private:
  using Edges = std::array<DoubleDoubleVec3, 3>;

  [[nodiscard]] double square_to_segment(const DoubleDoubleVec3& to_query, std::size_t edge) const;
  [[nodiscard]] bool is_beside(const Vec3& to_query) const;
  [[nodiscard]] double square_to_plane(const Edges& to_query) const;

  std::array<Vec3, 3> corners_;
  Edges edges_;  // edge i leads from corner i to the next
  std::array<DoubleDouble, 3> edge_squares_;
  std::size_t longest_;  // edge
  // Of the apex: how far along the longest edge, and beside it.
  DoubleDouble apex_;
  DoubleDoubleVec3 height_;
  DoubleDouble height_square_;
  bool is_thin_;  // it is the segments of its edges
};

}  // namespace raycone
