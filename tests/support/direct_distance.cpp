// Plane and barycentric sides by cross products; edges by projection.
#include "tests/support/direct_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace raycone::test {
namespace {

using Long = long double;
using Vector = std::array<Long, 3>;

Vector from(const Vec3& p) { return {p.x, p.y, p.z}; }
Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Long dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Long length(const Vector& a) { return std::sqrt(dot(a, a)); }

Long to_segment(const Vector& p, const Vector& a, const Vector& b) {
  const Vector ab = minus(b, a), ap = minus(p, a);
  const Long square = dot(ab, ab);
  const Long t = square > 0 ? std::clamp<Long>(dot(ap, ab) / square, 0, 1) : 0;
  return length({ap[0] - t * ab[0], ap[1] - t * ab[1], ap[2] - t * ab[2]});
}

Long to_triangle(const Vector& p, const std::array<Vector, 3>& corners) {
  Long least = std::numeric_limits<Long>::infinity();
  const Vector normal = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]));
  bool above = dot(normal, normal) > 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector &a = corners[i], &b = corners[(i + 1) % 3];
    least = std::min(least, to_segment(p, a, b));
    above = above && dot(cross(minus(b, a), minus(p, a)), normal) >= 0;
  }
  return above ? std::min(least, std::abs(dot(minus(p, corners[0]), normal)) / length(normal)) : least;
}

}  // namespace

long double direct_distance(const TriangleMesh& mesh, const Vec3& p) {
  Long least = std::numeric_limits<Long>::infinity();
  for (const Triangle& t : mesh.triangles) {
    least = std::min(
        least, to_triangle(from(p), {from(mesh.vertices[t[0]]), from(mesh.vertices[t[1]]), from(mesh.vertices[t[2]])}));
  }
  return least;
}

}  // namespace raycone::test
