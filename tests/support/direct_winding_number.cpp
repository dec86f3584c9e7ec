#include "tests/support/direct_winding_number.h"

#include <cmath>
#include <numbers>

#include "core/direct_sum.h"
#include "core/floating_point.h"
#include "core/predicates.h"

namespace raycone::test {
namespace {

using Wide = long double;

struct WideVec3 {
  Wide x, y, z;
};

WideVec3 minus(const Vec3& v, const Vec3& q) { return {Wide(v.x) - q.x, Wide(v.y) - q.y, Wide(v.z) - q.z}; }

Wide dot(const WideVec3& a, const WideVec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// Half the solid angle with 64 bits, and how much cancels in it.
struct Term {
  Wide half_angle;
  Wide cancellation;  // sum of absolute terms / |z|
};

Term term(const Vec3& va, const Vec3& vb, const Vec3& vc, const Vec3& q) {
  const WideVec3 a = minus(va, q), b = minus(vb, q), c = minus(vc, q);
  const Wide la = std::sqrt(dot(a, a)), lb = std::sqrt(dot(b, b)), lc = std::sqrt(dot(c, c));
  const Wide re = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  const Wide im = a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
  // Next to the inside of the triangle the sign of im, that of a half turn, may be all rounding: the exact side tells.
  const bool half_turn = re < 0 && std::abs(im) < 0x1p-40L * -re;
  const Wide signed_im = half_turn ? std::copysign(im, Wide(-plane_side(va, vb, vc, q))) : im;
  return {std::atan2(signed_im, re), 10 * la * lb * lc / (std::abs(re) + std::abs(im))};
}

}  // namespace

double direct_winding_number(const TriangleMesh& mesh, const Vec3& q) {
  constexpr Wide kTwelveBits = 4096;
  const DefaultFloatingPoint guard;
  Quad sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const Term wide = term(a, b, c, q);
    // Not less: a triangle of zero area seen from its own line is 0 / 0, and counts 0.
    sum += wide.cancellation < kTwelveBits ? Quad(wide.half_angle)
                                           : half_solid_angle(a, b, c, {q.x, q.y, q.z}, plane_side(a, b, c, q)).value;
  }
  return static_cast<double>(static_cast<Wide>(sum) / (2 * std::numbers::pi_v<Wide>));
}

Quad direct_winding_number_quad(const TriangleMesh& mesh, const Vec3& q) {
  const DefaultFloatingPoint guard;
  return raycone::direct_winding_number(mesh, {q.x, q.y, q.z}).value;
}

double perturbed_winding_number(const TriangleMesh& mesh, const Vec3& q, double step) {
  const DefaultFloatingPoint guard;
  const Quad e = step;
  return static_cast<double>(raycone::direct_winding_number(mesh, {q.x + e, q.y + e * e, q.z + e * e * e}).value);
}

}  // namespace raycone::test
