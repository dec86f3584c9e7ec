// Where a triangle is and how large: what bounds its field from afar.
#pragma once

#include "core/boundary/solid_angle_kernel.h"
#include "core/data/box.h"

namespace raycone {

struct TriangleExtent {
  Box box;
  double area;   // NaN where it is not known: such a triangle is near everywhere
  double width;  // across its longest side; NaN for a point
};

// Area and width are rounded up.
[[nodiscard]] TriangleExtent extent_of(const SolidTriangle& triangle);

// At most the square of the distance between the triangle and the box, and mostly not much less: the distance from the
// triangle's box, or that from its plane and, within the plane, from the line through an edge, whichever is larger.
[[nodiscard]] double square_of_gap(const SolidTriangle& triangle, const TriangleExtent& extent, const Box& box);

}  // namespace raycone
