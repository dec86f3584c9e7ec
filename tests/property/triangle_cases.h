// Triangles and points that try to break distances.
#pragma once

#include <array>
#include <cstdint>

#include "core/data/vec3.h"
#include "tests/support/shapes.h"

namespace raycone::test {

struct TriangleCase {
  int family = 0;  // of triangle_family_count()
  std::array<Vec3, 3> corners;
  Vec3 query;

  [[nodiscard]] double largest_coordinate() const;
};

[[nodiscard]] int triangle_family_count();

// A random member of a family: the shape (proper, needle, cap, sliver, segment), of a width down to 1e-300, the size
// and the distance from the origin, the query's distance from the triangle's inside, edges and corners, which goes down
// to 0, all at random. The largest coordinate of the triangle is in [1/2, 1).
[[nodiscard]] TriangleCase make_triangle_case(int family, Random& random);

struct DistanceError {
  double relative;  // to the distance by its definition; infinity where that is 0 and `distance` is not
  double absolute;  // in u = 2^-53 times the largest coordinate

  // The promise of docs/method.md.
  [[nodiscard]] bool is_small() const { return relative <= 1e-12 || absolute <= 4; }
};

[[nodiscard]] DistanceError error_of(const TriangleCase& c, double distance);

}  // namespace raycone::test
