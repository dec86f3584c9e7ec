#include "core/exact/predicates.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <cassert>

#include "core/machine/floating_point.h"

namespace raycone {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

// Coordinates `axis` and `axis + 1`, cyclically.
Kernel::Point_2 project(const Vec3& p, int axis) { return {p[axis], p[(axis + 1) % 3]}; }

Kernel::Point_3 point(const Vec3& p) { return {p.x, p.y, p.z}; }

int orientation_along(int axis, const Vec3& a, const Vec3& b, const Vec3& c) {
  assert(DefaultFloatingPoint::holds());
  return static_cast<int>(CGAL::orientation(project(a, axis), project(b, axis), project(c, axis)));
}

bool in_box(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& q) {
  for (int axis = 0; axis < 3; ++axis) {
    const double at = q[axis], of_a = a[axis], of_b = b[axis], of_c = c[axis];
    if ((at < of_a && at < of_b && at < of_c) || (at > of_a && at > of_b && at > of_c)) return false;
  }
  return true;
}

}  // namespace

int exact_edge_orientation(const Vec3& a, const Vec3& b, const Vec3& q) {
  // Level with each other, as most ties on lattices are.
  if ((a.y == q.y && b.y == q.y) || (a.z == q.z && b.z == q.z)) return 0;
  return orientation_along(1, a, b, q);
}

int plane_side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& q) {
  assert(DefaultFloatingPoint::holds());
  return static_cast<int>(CGAL::orientation(point(a), point(b), point(c), point(q)));
}

bool collinear(const Vec3& a, const Vec3& b, const Vec3& c) {
  return orientation_along(0, a, b, c) == 0 && orientation_along(1, a, b, c) == 0 && orientation_along(2, a, b, c) == 0;
}

bool on_segment(const Vec3& a, const Vec3& b, const Vec3& q) { return in_box(a, a, b, q) && collinear(a, b, q); }

bool on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& q) {
  if (!in_box(a, b, c, q)) return false;
  if (collinear(a, b, c)) return on_segment(a, b, q) || on_segment(b, c, q) || on_segment(c, a, q);
  if (plane_side(a, b, c, q) != 0) return false;
  for (int axis = 0; axis < 3; ++axis) {
    const int whole = orientation_along(axis, a, b, c);
    if (whole == 0) continue;  // projects to a segment along this axis: another one tells
    return orientation_along(axis, a, b, q) * whole >= 0 && orientation_along(axis, b, c, q) * whole >= 0 &&
           orientation_along(axis, c, a, q) * whole >= 0;
  }
  return false;
}

int meeting_side(const Vec3& a, const Vec3& b, const Vec3& q) {
  // x_c = (a_x b_k - b_x a_k) / (b_k - a_k) relative to q, for k = y or z with a_k != b_k.
  if (a.y != b.y) return orientation_along(0, a, b, q) * (b.y > a.y ? 1 : -1);
  return -orientation_along(2, a, b, q) * (b.z > a.z ? 1 : -1);
}

}  // namespace raycone
