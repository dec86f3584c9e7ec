#include "core/crossings/crossings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/data/interval.h"
#include "core/data/triangle_mesh.h"
#include "core/exact/predicates.h"

namespace raycone {
namespace {

Interval extent_along_x(const Vec3& a, const Vec3& b, const Vec3& c) {
  return {std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x})};
}

bool box_meets_line(const Vec3& a, const Vec3& b, const Vec3& c, const Row& row) {
  return row.y >= std::min({a.y, b.y, c.y}) && row.y <= std::max({a.y, b.y, c.y}) &&
         row.z >= std::min({a.z, b.z, c.z}) && row.z <= std::max({a.z, b.z, c.z});
}

// Samples [first, last): those before are surely before the plane, those from `last` on surely behind.
struct Doubtful {
  std::size_t first, last;
};

Doubtful doubtful_samples(const Vec3& a, const Vec3& b, const Vec3& c, const Row& row, const TrianglePlane* plane) {
  if (plane && plane->error < std::numeric_limits<double>::infinity()) {
    const double along = plane->normal.y * (row.y - a.y) + plane->normal.z * (row.z - a.z);
    const double x = a.x - along / plane->normal.x;
    const std::size_t first = count_below(row.xs, row.samples_per_unit, x - plane->error);
    std::size_t last = first;
    while (last < row.xs.size() && row.xs[last] <= x + plane->error) ++last;
    return {first, last};
  }
  const Interval box = extent_along_x(a, b, c);
  return {count_below(row.xs, row.samples_per_unit, box.lower), count_up_to(row.xs, row.samples_per_unit, box.upper)};
}

void find_crossing(const Vec3& a, const Vec3& b, const Vec3& c, const Row& row, const TrianglePlane* plane,
                   TriangleCrossing& result) {
  const auto side = [&](std::size_t i) { return plane_side(a, b, c, row.query(i)); };
  auto [first, last] = doubtful_samples(a, b, c, row, plane);
  const std::size_t end = last;
  while (first < last) {  // bisection: the side changes once
    const std::size_t middle = first + (last - first) / 2;
    if (side(middle) == -result.sigma) {
      first = middle + 1;
    } else {
      last = middle;
    }
  }
  result.crossed = first;
  result.on_begin = result.on_end = first;
  while (result.on_end < end && side(result.on_end) == 0) ++result.on_end;
}

// Where the row's line meets the edge from p to q, which their projections along x say is on one line: between these
// numbers, if at all. The fraction is off by at most 4 u of itself, which is at most 1, and the rest rounds to 3 u of
// |p.x| + |q.x|. u = 2^-53.
Interval meeting(const Vec3& p, const Vec3& q, const Row& row) {
  const Interval whole{std::min(p.x, q.x), std::max(p.x, q.x)};
  const Vec3 step = q - p;
  const int axis = std::abs(step.y) >= std::abs(step.z) ? 1 : 2;
  if (step[axis] == 0.0) return row.y == p.y && row.z == p.z ? whole : kEmptyInterval;
  const double at = axis == 1 ? row.y : row.z;
  if (at < std::min(p[axis], q[axis]) || at > std::max(p[axis], q[axis])) return kEmptyInterval;
  if (std::isinf(step[axis])) return whole;
  constexpr double kRounding = 0x1p-49, kUnderflow = 0x1p-1000;
  const double x = p.x + (at - p[axis]) / step[axis] * step.x;
  const Interval near = widened(Interval{x, x}, kRounding * (std::abs(p.x) + std::abs(q.x)) + kUnderflow);
  return near.empty() ? whole : near;  // NaN: what overflows
}

// A line that crosses no inside of a triangle meets it in an interval from edge to edge, so the samples on it are
// consecutive, and only those next to its ends are in doubt. Large flat triangles have many, fans of needles many
// intervals. `edges`: what the sides of edges from a, b and c say.
void find_samples_on(const Corners3& corners, const std::array<EdgeSide, 3>& edges, const Row& row,
                     TriangleCrossing& result) {
  Interval met = kEmptyInterval;
  for (std::size_t n = 0; n < 3; ++n) {
    if (edges[n].tie) met = hull(met, meeting(corners[n], corners[(n + 1) % 3], row));
  }
  if (met.empty()) return;
  const auto on = [&](std::size_t i) { return on_triangle(corners[0], corners[1], corners[2], row.query(i)); };
  std::size_t begin = count_below(row.xs, row.samples_per_unit, met.lower);
  std::size_t end = count_up_to(row.xs, row.samples_per_unit, met.upper);
  while (begin < end && !on(begin)) ++begin;
  while (begin < end && !on(end - 1)) --end;
  result.on_begin = begin;
  result.on_end = end;
}

}  // namespace

// Each component of the normal is off by at most 4 u times the same with absolute values, N+; the differences to a,
// products and sums round once each; the quotient carries the normal's x (relative error at most 4 / 60 by the
// condition) and x_c - a_x is within the box. Together less than 8 u sum N+_k H_k / |n_x| with H the box's extent, and
// two roundings of the result. What underflows in a component of the normal is below 2^-1073; it is multiplied by H and
// divided by n_x, too, as is what underflows in the products with H. u = 2^-53.
TrianglePlane::TrianglePlane(const Vec3& a, const Vec3& b, const Vec3& c) {
  constexpr double u = 0x1p-53;
  constexpr double kNoUnderflow = 0x1p-900;
  const Vec3 e = b - a, f = c - a;
  normal = cross(e, f);
  const Vec3 bound = cross_terms(e, f);
  const double nx = std::abs(normal.x);
  // Written so that NaN has no error bound.
  if (!(nx > 64 * u * bound.x && nx > kNoUnderflow && bound.x + bound.y + bound.z < 1 / kNoUnderflow)) {
    error = std::numeric_limits<double>::infinity();
    return;
  }
  double reach = 0.0, extent = 1.0, largest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    // Not of lists, whose loops branch.
    const double lower = std::min(std::min(a[axis], b[axis]), c[axis]);
    const double upper = std::max(std::max(a[axis], b[axis]), c[axis]);
    reach += bound[axis] * (upper - lower);
    extent += upper - lower;
    if (axis == 0) largest = std::max(std::abs(lower), std::abs(upper));
  }
  constexpr double kUnderflow = 0x1p-1070, kRest = 0x1p-900;  // what underflows before and after the division
  error = 1.01 * u * (8 * reach / nx + 2 * largest) + kUnderflow / nx * extent + kRest;
}

TriangleCrossing triangle_crossing(const Vec3& a, const Vec3& b, const Vec3& c, const Row& row,
                                   const TrianglePlane* plane) {
  TriangleCrossing result;
  const Vec3 line = row.query(0);  // sides depend on y and z alone
  const EdgeSide ab = edge_side(a, b, line), bc = edge_side(b, c, line), ca = edge_side(c, a, line);
  const bool crossed = ab.sign != 0 && bc.sign == ab.sign && ca.sign == ab.sign;
  result.ties = ab.tie + bc.tie + ca.tie;
  if (!crossed && result.ties == 0) return result;
  if (!box_meets_line(a, b, c, row)) return {};  // a tie with the line of an edge, beyond the triangle
  if (result.ties > 0) result.met = count_up_to(row.xs, row.samples_per_unit, extent_along_x(a, b, c).upper);
  if (crossed) {
    result.sigma = ab.sign;
    find_crossing(a, b, c, row, plane, result);
  } else {
    find_samples_on({a, b, c}, {ab, bc, ca}, row, result);
  }
  return result;
}

}  // namespace raycone
