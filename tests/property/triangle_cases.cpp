#include "tests/property/triangle_cases.h"

#include <algorithm>
#include <cmath>

#include "core/exact/direct_distance.h"

namespace raycone::test {
namespace {

constexpr Box kCube{{-1, -1, -1}, {1, 1, 1}};

bool chance(Random& random, int of) { return random() % static_cast<unsigned>(of) == 0; }

double power(Random& random, double from, double to) { return std::pow(10.0, uniform(random, from, to)); }

Vec3 direction(Random& random) { return uniform_point(random, kCube); }

// What the third corner is beside the first two, a and b; `width` is in units of their distance.
Vec3 third_corner(int family, const Vec3& a, const Vec3& b, double width, Random& random) {
  const double size = std::sqrt(dot(b - a, b - a));
  const Vec3 aside = width * size * direction(random);
  switch (family) {
    case 0:  // proper
      return a + size * direction(random);
    case 1:  // a cap: nearly a segment, the third corner within it
      return a + uniform(random, 0, 1) * (b - a) + aside;
    case 2:  // a needle, its short edge at a
      return a + aside;
    case 3:  // at b
      return b + aside;
    case 4:  // a sliver that goes beyond b or a
      return a + uniform(random, -3, 3) * (b - a) + aside;
    default:  // a segment, or a point
      return chance(random, 2) ? b : a;
  }
}

// A point of the triangle: inside, on an edge, a corner; or of its plane, beyond it.
Vec3 foot(const std::array<Vec3, 3>& corners, Random& random) {
  const auto& [a, b, c] = corners;
  double s = uniform(random, 0, 1), t = uniform(random, 0, 1);
  if (s + t > 1) s = 1 - s, t = 1 - t;
  switch (random() % 5) {
    case 0:
      return a + s * (b - a) + t * (c - a);
    case 1:
      return a + s * (b - a);
    case 2:
      return b + s * (c - b);
    case 3:
      return corners[random() % 3];
    default:
      return a + 3 * s * (b - a) + (2 * t - 1) * (c - a);
  }
}

// Off the triangle in any direction, or at right angles to it, as far as 64 bits tell, so that also far from a needle
// its inside is nearest.
Vec3 off(const std::array<Vec3, 3>& corners, Random& random) {
  using Long = long double;
  const auto& [a, b, c] = corners;
  const auto minus = [](const Vec3& p, const Vec3& q) {
    return std::array<Long, 3>{Long{p.x} - q.x, Long{p.y} - q.y, Long{p.z} - q.z};
  };
  const auto ab = minus(b, a), ac = minus(c, a);
  const std::array<Long, 3> normal{ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2],
                                   ab[0] * ac[1] - ab[1] * ac[0]};
  const Long size = std::hypot(normal[0], normal[1], normal[2]);
  if (chance(random, 2) || !(size > 0)) return direction(random);
  return {static_cast<double>(normal[0] / size), static_cast<double>(normal[1] / size),
          static_cast<double>(normal[2] / size)};
}

// Along coordinate planes much is exact, and ties are frequent.
void flatten(std::array<Vec3, 3>& corners, Random& random) {
  const int axis = static_cast<int>(random() % 3);
  for (Vec3& corner : corners) corner[axis] = corners[0][axis];
}

double largest_of(const std::array<Vec3, 3>& corners) {
  return std::max({raycone::largest_coordinate(corners[0]), raycone::largest_coordinate(corners[1]),
                   raycone::largest_coordinate(corners[2])});
}

}  // namespace

double TriangleCase::largest_coordinate() const {
  return std::max(largest_of(corners), raycone::largest_coordinate(query));
}

int triangle_family_count() { return 6; }

TriangleCase make_triangle_case(int family, Random& random) {
  TriangleCase result;
  result.family = family;
  const double size = chance(random, 2) ? 1.0 : power(random, -6, 0);
  const double width = chance(random, 8) ? power(random, -300, 0) : power(random, -20, 0);
  auto& [a, b, c] = result.corners;
  a = direction(random);
  b = a + size * direction(random);
  c = third_corner(family, a, b, width, random);
  if (chance(random, 3)) flatten(result.corners, random);
  const double scale = std::ldexp(1.0, -std::ilogb(largest_of(result.corners)) - 1);
  for (Vec3& corner : result.corners) corner = scale * corner;
  const double distance = chance(random, 10) ? 0.0 : size * scale * power(random, -18, 1);
  result.query = foot(result.corners, random) + distance * off(result.corners, random);
  return result;
}

DistanceError error_of(const TriangleCase& c, double distance) {
  const auto& [p0, p1, p2] = c.corners;
  const Quad exact = direct_distance({{p0, p1, p2}, {{0, 1, 2}}}, c.query);
  const auto error = std::abs(static_cast<double>(Quad{distance} - exact));
  const double relative = error == 0.0 ? 0.0 : exact == 0 ? HUGE_VAL : error / static_cast<double>(exact);
  return {relative, error / c.largest_coordinate() / 0x1p-53};
}

}  // namespace raycone::test
