// Signs of determinants in integer arithmetic of any length: the oracle of core/exact/predicates.h, with which it
// shares no code. Exact for all finite doubles, given denormal numbers (DefaultFloatingPoint). Microseconds each.
#pragma once

#include "core/data/vec3.h"

namespace raycone::test {

// Sign of D = a_y b_z - a_z b_y of the differences to q: -1, 0 or +1.
[[nodiscard]] int exact_edge_side(const Vec3& a, const Vec3& b, const Vec3& q);

// Sign of det(b - a, c - a, q - a): +1 where q is in front of the triangle.
[[nodiscard]] int exact_plane_side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& q);

// Whether the triangle has no area.
[[nodiscard]] bool exactly_collinear(const Vec3& a, const Vec3& b, const Vec3& c);

// Whether q is a point of the closed triangle, which may be a segment or a point.
[[nodiscard]] bool exactly_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& q);

}  // namespace raycone::test
