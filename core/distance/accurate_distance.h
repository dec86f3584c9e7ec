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
  using Edges = std::array<DoubleDoubleVec3, 3>;

  AccurateTriangle(const Vec3& a, const Vec3& b, const Vec3& c);

  // The square of the distance from p to the closed triangle: that distance is off by less than 1e-15 of itself or
  // 1e-16 of the largest coordinate, which is 1/2 or more (docs/method.md, "Distances"). Coordinates below 2^400 in
  // magnitude. Costs some tenths of a microsecond.
  [[nodiscard]] double squared_distance(const Vec3& p) const;

  // What it is prepared of, for kernels that do the same in lanes.
  struct Parts {
    std::array<Vec3, 3> corners;
    Edges edges;  // edge i leads from corner i to the next
    std::array<DoubleDouble, 3> edge_squares;
    std::size_t longest;  // edge
    // Of the apex: how far along the longest edge, and beside it.
    DoubleDouble apex;
    DoubleDoubleVec3 height;
    DoubleDouble height_square;
    bool is_thin;  // it is the segments of its edges
  };
  [[nodiscard]] const Parts& parts() const { return parts_; }

  // An edge that short, squared, is a point: beyond, products would underflow.
  static constexpr double kPoint = 1e-250;

 private:
  [[nodiscard]] double square_to_segment(const DoubleDoubleVec3& to_query, std::size_t edge) const;
  [[nodiscard]] bool is_beside(const Vec3& to_query) const;
  [[nodiscard]] double square_to_plane(const Edges& to_query) const;

  Parts parts_;
};

}  // namespace raycone
