#include "core/exact/direct_gradient.h"

#include <quadmath.h>

#include <utility>

namespace raycone {
namespace {

Quad side_dot(const QuadVec3& a, const QuadVec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

QuadVec3 side_cross(const QuadVec3& a, const QuadVec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// The integral of dl x r / |r|^3 over the side: (1 / d^2) (d x a) times the difference of the cosines at its ends, d
// being the distance of q from its line.
void add_side(const Vec3& from, const Vec3& to, const Vec3& q, DirectGradient& sum) {
  const bool swapped = lexicographic_order(to, from) < 0;
  const Vec3& first = swapped ? to : from;
  const Vec3& second = swapped ? from : to;
  const QuadVec3 a{Quad(first.x) - q.x, Quad(first.y) - q.y, Quad(first.z) - q.z};
  const QuadVec3 b{Quad(second.x) - q.x, Quad(second.y) - q.y, Quad(second.z) - q.z};
  const QuadVec3 step{Quad(second.x) - first.x, Quad(second.y) - first.y, Quad(second.z) - first.z};
  const Quad aa = side_dot(a, a), bb = side_dot(b, b);
  const QuadVec3 normal = side_cross(aa < bb ? a : b, step);
  const Quad square = side_dot(normal, normal);
  if (square == 0) return;
  const Quad cosines = side_dot(b, step) / sqrtq(bb) - side_dot(a, step) / sqrtq(aa);
  const Quad factor = (swapped ? -1 : 1) * cosines / square / (16 * atanq(1));
  sum.value.x += factor * normal.x;
  sum.value.y += factor * normal.y;
  sum.value.z += factor * normal.z;
  sum.magnitude += absolute(factor) * sqrtq(square);
}

}  // namespace

DirectGradient direct_gradient(const TriangleMesh& mesh, const Vec3& q) {
  DirectGradient sum;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) add_side(mesh.vertices[t[i]], mesh.vertices[t[(i + 1) % 3]], q, sum);
  }
  return sum;
}

}  // namespace raycone
