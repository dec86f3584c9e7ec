#include "tests/support/exact_intersections.h"

#include <algorithm>
#include <boost/multiprecision/gmp.hpp>

namespace raycone::test {
namespace {

using Rational = boost::multiprecision::mpq_rational;

struct Point {
  Rational x, y, z;
  friend bool operator==(const Point& a, const Point& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
};

Point exact(const Vec3& p) { return {Rational(p.x), Rational(p.y), Rational(p.z)}; }
Point minus(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Point negative(const Point& a) { return {-a.x, -a.y, -a.z}; }
Rational dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Point cross(const Point& a, const Point& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
bool is_zero(const Point& a) { return a == Point{}; }

// Where normal . (x - on) >= 0.
struct HalfSpace {
  Point normal, on;
};

void add_plane(std::vector<HalfSpace>& all, const Point& normal, const Point& on) {
  all.push_back({normal, on});
  all.push_back({negative(normal), on});
}

using ExactTriangle = std::array<Point, 3>;

// The half-spaces whose intersection is the triangle.
std::vector<HalfSpace> half_spaces(const ExactTriangle& t) {
  std::vector<HalfSpace> all;
  const Point normal = cross(minus(t[1], t[0]), minus(t[2], t[0]));
  if (!is_zero(normal)) {
    add_plane(all, normal, t[0]);
    for (std::size_t i = 0; i < 3; ++i) all.push_back({cross(normal, minus(t[(i + 1) % 3], t[i])), t[i]});
    return all;
  }
  // The two corners that are farthest apart span it.
  Point from = t[0], to = t[0];
  for (const Point& a : t) {
    for (const Point& b : t) {
      if (dot(minus(b, a), minus(b, a)) > dot(minus(to, from), minus(to, from))) from = a, to = b;
    }
  }
  const Point along = minus(to, from);
  for (const Point& axis : {Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}}) {
    add_plane(all, is_zero(along) ? axis : cross(along, axis), from);
  }
  if (!is_zero(along)) {
    all.push_back({along, from});
    all.push_back({negative(along), to});
  }
  return all;
}

// What a half-space leaves of a convex polygon, which may be a segment or a point (Sutherland and Hodgman 1974).
std::vector<Point> cut(const std::vector<Point>& polygon, const HalfSpace& half) {
  std::vector<Point> rest;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const Rational at_a = dot(half.normal, minus(a, half.on)), at_b = dot(half.normal, minus(b, half.on));
    if (at_a >= 0) rest.push_back(a);
    if ((at_a > 0 && at_b < 0) || (at_a < 0 && at_b > 0)) {
      const Rational part = at_a / (at_a - at_b);
      const Point way = minus(b, a);
      rest.push_back({a.x + part * way.x, a.y + part * way.y, a.z + part * way.z});
    }
  }
  return rest;
}

bool lies_on(const Point& p, const Point& from, const Point& to) {
  const Point along = minus(to, from), way = minus(p, from);
  return is_zero(cross(along, way)) && dot(along, way) >= 0 && dot(along, way) <= dot(along, along) &&
         (!is_zero(along) || is_zero(way));
}

bool boxes_meet(const std::array<Vec3, 3>& s, const std::array<Vec3, 3>& t) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto [s_low, s_high] = std::minmax({s[0][axis], s[1][axis], s[2][axis]});
    const auto [t_low, t_high] = std::minmax({t[0][axis], t[1][axis], t[2][axis]});
    if (s_high < t_low || t_high < s_low) return false;
  }
  return true;
}

}  // namespace

bool exactly_meet_beyond_shared(const std::array<Vec3, 3>& s, const std::array<Vec3, 3>& t) {
  const ExactTriangle a{exact(s[0]), exact(s[1]), exact(s[2])}, b{exact(t[0]), exact(t[1]), exact(t[2])};
  std::vector<Point> common(a.begin(), a.end());
  for (const HalfSpace& half : half_spaces(b)) {
    common = cut(common, half);
    if (common.empty()) return false;
  }
  std::vector<Point> shared;
  for (const Point& corner : a) {
    if (std::ranges::find(b, corner) != b.end()) shared.push_back(corner);
  }
  // What they have in common is convex: it lies on shared vertices and edges where it lies on one of them.
  for (const Point& from : shared) {
    for (const Point& to : shared) {
      if (std::ranges::all_of(common, [&](const Point& p) { return lies_on(p, from, to); })) return false;
    }
  }
  return true;
}

std::vector<std::array<std::uint32_t, 2>> exact_self_intersections(const TriangleMesh& mesh) {
  const auto corners = [&mesh](std::uint32_t i) {
    const Triangle& t = mesh.triangles[i];
    return std::array<Vec3, 3>{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
  };
  std::vector<std::array<std::uint32_t, 2>> pairs;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    for (std::uint32_t j = i + 1; j < mesh.triangles.size(); ++j) {
      if (boxes_meet(corners(i), corners(j)) && exactly_meet_beyond_shared(corners(i), corners(j))) {
        pairs.push_back({i, j});
      }
    }
  }
  return pairs;
}

}  // namespace raycone::test
