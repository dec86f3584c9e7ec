#include "tests/support/exact_predicates.h"

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>

namespace raycone::test {
namespace {

using Integer = boost::multiprecision::cpp_int;

struct Vector {
  Integer x, y, z;
};

Vector minus(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Integer dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vector cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
bool is_zero(const Vector& a) { return a.x == 0 && a.y == 0 && a.z == 0; }
int sign(const Integer& x) { return x.sign(); }

// A double as significand * 2^exponent.
struct Parts {
  std::int64_t significand = 0;
  int exponent = std::numeric_limits<int>::max();  // of 0: any
};

Parts parts_of(double x) {
  if (x == 0.0) return {};
  int exponent = 0;
  const double fraction = std::frexp(x, &exponent);
  return {static_cast<std::int64_t>(std::ldexp(fraction, 53)), exponent - 53};
}

// The points times the one power of two that makes all coordinates integers.
template <std::size_t n>
std::array<Vector, n> integers(const std::array<Vec3, n>& points) {
  int least = std::numeric_limits<int>::max();
  for (const Vec3& p : points) {
    for (const double x : {p.x, p.y, p.z}) least = std::min(least, parts_of(x).exponent);
  }
  const auto integer = [&](double x) {
    const Parts parts = parts_of(x);
    const Integer magnitude(std::abs(parts.significand));
    const Integer shifted =
        parts.significand == 0 ? Integer(0) : Integer(magnitude << static_cast<unsigned>(parts.exponent - least));
    return parts.significand < 0 ? Integer(-shifted) : shifted;
  };
  std::array<Vector, n> result;
  for (std::size_t i = 0; i < n; ++i) result[i] = {integer(points[i].x), integer(points[i].y), integer(points[i].z)};
  return result;
}

bool on_segment(const Vector& a, const Vector& b, const Vector& q) {
  const Vector along = minus(b, a), to_q = minus(q, a);
  const Integer place = dot(along, to_q);
  return is_zero(cross(along, to_q)) && place >= 0 && place <= dot(along, along) && (!is_zero(along) || is_zero(to_q));
}

bool in_box(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& q) {
  for (int axis = 0; axis < 3; ++axis) {
    if (q[axis] < std::min({a[axis], b[axis], c[axis]}) || q[axis] > std::max({a[axis], b[axis], c[axis]}))
      return false;
  }
  return true;
}

}  // namespace

int exact_edge_side(const Vec3& a, const Vec3& b, const Vec3& q) {
  const auto [pa, pb, pq] = integers<3>({{{0, a.y, a.z}, {0, b.y, b.z}, {0, q.y, q.z}}});
  return sign(cross(minus(pa, pq), minus(pb, pq)).x);
}

int exact_plane_side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& q) {
  const auto [pa, pb, pc, pq] = integers<4>({a, b, c, q});
  return sign(dot(cross(minus(pb, pa), minus(pc, pa)), minus(pq, pa)));
}

bool exactly_collinear(const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto [pa, pb, pc] = integers<3>({a, b, c});
  return is_zero(cross(minus(pb, pa), minus(pc, pa)));
}

bool exactly_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& q) {
  if (!in_box(a, b, c, q)) return false;  // comparisons are exact, and spare most of the work
  const std::array<Vector, 4> points = integers<4>({a, b, c, q});
  const Vector &pa = points[0], &pb = points[1], &pc = points[2], &pq = points[3];
  const Vector normal = cross(minus(pb, pa), minus(pc, pa));
  if (is_zero(normal)) return on_segment(pa, pb, pq) || on_segment(pb, pc, pq) || on_segment(pc, pa, pq);
  const auto left_of = [&](const Vector& from, const Vector& to) {
    return dot(cross(minus(to, from), minus(pq, from)), normal) >= 0;
  };
  return dot(normal, minus(pq, pa)) == 0 && left_of(pa, pb) && left_of(pb, pc) && left_of(pc, pa);
}

}  // namespace raycone::test
