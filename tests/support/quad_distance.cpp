// Plane and barycentric sides by cross products; edges by projection.
#include "tests/support/quad_distance.h"

#include <quadmath.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace raycone::test {
namespace {

using Real = __float128;
using Vector = std::array<Real, 3>;

Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Real dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Real length(const Vector& a) { return sqrtq(dot(a, a)); }

Real to_segment(const Vector& p, const Vector& a, const Vector& b) {
  const Vector ab = minus(b, a), ap = minus(p, a);
  const Real square = dot(ab, ab);
  const Real t = square > 0 ? std::clamp<Real>(dot(ap, ab) / square, 0, 1) : Real(0);
  return length({ap[0] - t * ab[0], ap[1] - t * ab[1], ap[2] - t * ab[2]});
}

Real to_triangle(const Vector& p, const std::array<Vector, 3>& corners) {
  const Vector normal = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]));
  bool above = dot(normal, normal) > 0;
  Real least = HUGE_VAL;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector &a = corners[i], &b = corners[(i + 1) % 3];
    least = std::min(least, to_segment(p, a, b));
    above = above && dot(cross(minus(b, a), minus(p, a)), normal) >= 0;
  }
  if (!above) return least;
  const Real height = dot(minus(p, corners[0]), normal) / length(normal);
  return std::min(least, height < 0 ? -height : height);
}

}  // namespace

__float128 quad_distance(const TriangleMesh& mesh, const Vec3& p) {
  const auto wide = [](const Vec3& v) { return Vector{v.x, v.y, v.z}; };
  Real least = HUGE_VAL;
  for (const Triangle& t : mesh.triangles) {
    least = std::min(
        least, to_triangle(wide(p), {wide(mesh.vertices[t[0]]), wide(mesh.vertices[t[1]]), wide(mesh.vertices[t[2]])}));
  }
  return least;
}

}  // namespace raycone::test
