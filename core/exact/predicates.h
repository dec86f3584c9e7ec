// Exact predicates, and the one symbolic perturbation that decides their ties.
//
// All rays point along +x. A query q stands for q + (e1, e2, e3) with infinitesimals e1 >> e2 >> e3 > 0 (Edelsbrunner &
// Muecke 1990): the perturbed ray meets no edge and no vertex, and the perturbed query lies on no triangle. The rules
// that follow from it are stated here and nowhere else; crossings and cone both take their signs from edge_side(), so
// that the integer and the fractional part of a winding number jump together.
//
// Edge side. For an edge a -> b and p = v - q, D = a_y b_z - a_z b_y (of the p's) is the 2D orientation of the edge,
// projected along the ray, as seen from q, and the imaginary part of the edge's term in the cone. Where D = 0, the
// perturbation makes it e2 (a_z - b_z) + e3 (b_y - a_y), so the first of these two that is not zero decides; if both
// are zero the edge projects to a point, has no side, and no triangle with it is crossed.
//
// Plane side. orient3d = 0 means that q lies on the triangle's plane; e1 moves it past the plane, so the ray, which
// points along +x too, does not cross.
#pragma once

#include <cmath>

#include "core/data/vec3.h"
#include "core/exact/sure_sign.h"

namespace raycone {

// Sign of the edge's side for the perturbed query: +1, -1, or 0 where the edge projects to a point. `tie`: D is 0.
struct EdgeSide {
  int sign = 0;
  bool tie = false;
};

// What follows is exact for all finite doubles. Thread-safe; needs DefaultFloatingPoint.

// Sign of D, exact: -1, 0 or +1. Depends on the y and z of its arguments only.
[[nodiscard]] int exact_edge_orientation(const Vec3& a, const Vec3& b, const Vec3& q);

// D in floating point.
struct EdgeDeterminant {
  double value = 0.0;
  double terms = 0.0;  // the sum of the absolute values of its two products
};

// D = P_a x d = P_b x d with d = b - a, from one of the ends.
[[nodiscard]] inline EdgeDeterminant determinant_from(const Vec3& end, const Vec3& a, const Vec3& b, const Vec3& q) {
  const double left = (end.y - q.y) * (b.z - a.z), right = (end.z - q.z) * (b.y - a.y);
  return {left - right, std::abs(left) + std::abs(right)};
}

// D from the end that is nearer in projection: the error is a few u times `terms`, which shrinks with the edge and with
// the distance from that end. From the farther end a query level with a vertex, as on lattices, would lose all digits
// of D.
[[nodiscard]] inline EdgeDeterminant edge_determinant(const Vec3& a, const Vec3& b, const Vec3& q) {
  const bool a_is_nearer = std::abs(a.y - q.y) + std::abs(a.z - q.z) <= std::abs(b.y - q.y) + std::abs(b.z - q.z);
  return determinant_from(a_is_nearer ? a : b, a, b, q);
}

// Floating point vouches for the sign of D^ where |D^| exceeds this many times `terms`, plus kSideUnderflow. Each
// factor is rounded once (two of them: 2 u), each product (u) and the difference (u), so 4 u is a bound but for
// second-order terms; u = 2^-53.
inline constexpr double kSideFilter = 4.0 * 0x1p-53 * (1.0 + 0x1p-50);
inline constexpr double kSideUnderflow = 0x1p-1000;  // far more than a product loses that is below all doubles

// The sign of D where that is sure, else 0.
[[nodiscard]] inline int sure_sign(const EdgeDeterminant& d) {
  return sure_sign(d.value, kSideFilter * d.terms + kSideUnderflow);
}

[[nodiscard]] inline EdgeSide broken_tie(const Vec3& a, const Vec3& b) {
  if (a.z != b.z) return {a.z > b.z ? 1 : -1, true};
  if (a.y != b.y) return {b.y > a.y ? 1 : -1, true};
  return {0, true};
}

[[nodiscard]] inline EdgeSide edge_side(const Vec3& a, const Vec3& b, const Vec3& q) {
  // From either end a sure sign is the right one; which is nearer, no processor can foresee.
  if (const int sign = sure_sign(determinant_from(a, a, b, q)); sign != 0) return {sign, false};
  if (const int sign = sure_sign(determinant_from(b, a, b, q)); sign != 0) return {sign, false};
  const int sign = exact_edge_orientation(a, b, q);
  return sign != 0 ? EdgeSide{sign, false} : broken_tie(a, b);
}

// Sign of det(b - a, c - a, q - a): positive where q lies on the front side of the triangle.
[[nodiscard]] int plane_side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& q);

// Whether q lies on the closed triangle: inside, on an edge or at a vertex; a triangle of zero area is a segment or a
// point.
[[nodiscard]] bool on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& q);

// Whether q lies on the closed segment from a to b, which may be a point.
[[nodiscard]] bool on_segment(const Vec3& a, const Vec3& b, const Vec3& q);

// Whether the three points lie on one line.
[[nodiscard]] bool collinear(const Vec3& a, const Vec3& b, const Vec3& c);

// For an edge a -> b that the line through q along x meets (D = 0, not projecting to a point): the sign of x - q_x of
// the meeting point.
[[nodiscard]] int meeting_side(const Vec3& a, const Vec3& b, const Vec3& q);

}  // namespace raycone
