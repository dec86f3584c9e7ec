#include "core/exact/direct_gradient.h"

#include <quadmath.h>

#include "core/exact/exact_determinant.h"

namespace raycone {
namespace {

const Quad kFullSolidAngle = 16 * atanq(1);  // 4 pi

// The integral of dl x r / |r|^3 over the side: (1 / d^2) (d x a) times the difference of the cosines at its ends, d
// being the distance of q from its line. Where q is beyond an end the cosines are about the same; then their difference
// is that of the sines' squares, d^2 (1 / |a|^2 - 1 / |b|^2), over the cosines' sum.
Quad cosines_by_square(const QuadVec3& a, const QuadVec3& b, const QuadVec3& step, const Quad& square) {
  const Quad aa = dot(a, a), bb = dot(b, b), la = sqrtq(aa), lb = sqrtq(bb);
  // From there on what tells the ends apart may be lost, and |r| is that of the middle, but for 2^-80 of it.
  constexpr double kFar = 0x1p80;
  if (aa > kFar * dot(step, step)) return 8 / ((la + lb) * (la + lb) * (la + lb));
  const Quad at_a = dot(a, step), at_b = dot(b, step), cos_a = at_a / la, cos_b = at_b / lb;
  const bool is_beyond = (at_a > 0) == (at_b > 0);
  return is_beyond ? (at_a + at_b) / (aa * bb * (cos_a + cos_b)) : (cos_b - cos_a) / square;
}

// (first - q) x (second - q), to 2^-80 of its length. Each component of the rounded differences' product is off by four
// roundings of |a| |b|, all of it by seven: that will do where it is 2^-30 of |a| |b| or more. Elsewhere differences
// are exact, which takes three times as long.
QuadVec3 normal_of(const Vec3& first, const Vec3& second, const Vec3& q, const QuadVec3& a, const QuadVec3& b) {
  constexpr double kCancels = 0x1p-60;
  const QuadVec3 rounded = cross(a, b);
  const bool is_sure = dot(rounded, rounded) > kCancels * dot(a, a) * dot(b, b);
  return is_sure ? rounded : cross_of_differences(first, second, q);
}

void add_side(const Vec3& from, const Vec3& to, const Vec3& q, DirectGradient& sum) {
  const bool swapped = lexicographic_order(to, from) < 0;
  const Vec3& first = swapped ? to : from;
  const Vec3& second = swapped ? from : to;
  const QuadVec3 a = quad_difference(first, q), b = quad_difference(second, q), step = quad_difference(second, first);
  const QuadVec3 normal = normal_of(first, second, q, a, b);
  const Quad square = dot(normal, normal);
  if (square == 0) return;
  const Quad factor = (swapped ? -1 : 1) * cosines_by_square(a, b, step, square) / kFullSolidAngle;
  sum.value = sum.value + factor * normal;
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
