#include "core/direct_sum.h"

#include <quadmath.h>

#include "core/predicates.h"

namespace raycone {
namespace {

const Quad kPi = 4 * atanq(1);

Quad dot(const QuadVec3& a, const QuadVec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

QuadVec3 minus(const Vec3& v, const QuadVec3& q) { return {v.x - q.x, v.y - q.y, v.z - q.z}; }

// Real and imaginary part sum ten products of three lengths' magnitude; each has at most twelve roundings of 2^-113
// (differences, norms, products, sums), in both parts.
constexpr Quad kRoundings = 2 * 10 * 12 * 0x1p-113;

}  // namespace

QuadWithin half_solid_angle(const Vec3& va, const Vec3& vb, const Vec3& vc, const QuadVec3& q, int side) {
  const QuadVec3 a = minus(va, q), b = minus(vb, q), c = minus(vc, q);
  const Quad la = sqrtq(dot(a, a)), lb = sqrtq(dot(b, b)), lc = sqrtq(dot(c, c));
  const Quad re = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  const Quad im = a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
  const Quad error = kRoundings * la * lb * lc / (fabsq(re) + fabsq(im));
  const bool half_turn = re < 0 && fabsq(im) <= error * (fabsq(re) + fabsq(im));
  // No digit is left; or, next to the inside of the triangle, the sign of a half turn is not.
  if (!(error < 0.001) || (half_turn && side == 0)) return {0, kPi};
  return {atan2q(half_turn ? copysignq(im, -side) : im, re), error};
}

QuadWithin direct_winding_number(const TriangleMesh& mesh, const QuadVec3& q) {
  QuadWithin sum{0, 0};
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    QuadWithin term = half_solid_angle(a, b, c, q);
    if (term.error == kPi && collinear(a, b, c)) term = {0, 0};
    sum.value += term.value;
    sum.error += term.error;
  }
  return {sum.value / (2 * kPi), sum.error / (2 * kPi)};
}

}  // namespace raycone
