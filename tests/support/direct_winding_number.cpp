#include "tests/support/direct_winding_number.h"

#include <quadmath.h>

#include <cmath>

#include "core/machine/floating_point.h"
#include "tests/support/exact_predicates.h"

namespace raycone::test {
namespace {

using Wide = long double;
using Quad = __float128;

const Quad kPi = 4 * atanq(1);

Wide root(Wide x) { return std::sqrt(x); }
Quad root(Quad x) { return sqrtq(x); }
Wide magnitude(Wide x) { return std::abs(x); }
Quad magnitude(Quad x) { return fabsq(x); }

template <class Real>
struct Vector {
  Real x, y, z;
};

template <class Real>
Vector<Real> minus(const Vec3& v, const Vector<Real>& q) {
  return {v.x - q.x, v.y - q.y, v.z - q.z};
}
template <class Real>
Real dot(const Vector<Real>& a, const Vector<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Tangent of half the solid angle, as im / re.
template <class Real>
struct HalfAngle {
  Real re, im;
  Real lengths;  // the product of the corners' distances: the size of the terms that re and im are sums of
  [[nodiscard]] Real cancellation() const { return lengths / (magnitude(re) + magnitude(im)); }
};

template <class Real>
HalfAngle<Real> half_angle(const Vec3& va, const Vec3& vb, const Vec3& vc, const Vector<Real>& q) {
  const Vector<Real> a = minus(va, q), b = minus(vb, q), c = minus(vc, q);
  const Real la = root(dot(a, a)), lb = root(dot(b, b)), lc = root(dot(c, c));
  return {la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb,
          a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x), la * lb * lc};
}

// Next to the inside of the triangle the sign of im, that of a half turn, may be all rounding: the exact one tells.
template <class Real>
bool is_half_turn(const HalfAngle<Real>& t, Real unit) {
  return t.re < 0 && magnitude(t.im) <= unit * t.lengths;
}

// re and im sum ten products of at most `lengths` in magnitude, six times that in all (Cauchy and Schwarz), with at
// most 16 roundings each (differences, lengths, products, sums): 96 of them, times the square root of 2 for |re| + |im|
// in place of |z|.
constexpr Quad kRoundings = 136 * 0x1p-113;

// `side` of the triangle that q lies on, 0 where it is not known.
template <class Side>
WithinQuad quad_term(const Vec3& a, const Vec3& b, const Vec3& c, const Vector<Quad>& q, const Side& side) {
  const HalfAngle<Quad> t = half_angle(a, b, c, q);
  const Quad error = kRoundings * t.cancellation();
  // Not `error >= 0.001`: a triangle of zero area seen from its own line is 0 / 0.
  if (!(error < 0.001)) return exactly_collinear(a, b, c) ? WithinQuad{0, 0} : WithinQuad{0, kPi};
  if (!is_half_turn(t, kRoundings)) return {atan2q(t.im, t.re), error};
  const int in_front = side();
  return in_front == 0 ? WithinQuad{0, kPi} : WithinQuad{atan2q(copysignq(t.im, -in_front), t.re), error};
}

template <class Term>
WithinQuad sum_of(const TriangleMesh& mesh, const Term& term) {
  const DefaultFloatingPoint guard;
  WithinQuad sum;
  for (const Triangle& t : mesh.triangles) {
    const WithinQuad one = term(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
    sum.value += one.value;
    sum.error += one.error;
  }
  return {sum.value / (2 * kPi), sum.error / (2 * kPi)};
}

WithinQuad exact_term(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& q) {
  return quad_term(a, b, c, {q.x, q.y, q.z}, [&] { return exact_plane_side(a, b, c, q); });
}

}  // namespace

double direct_winding_number(const TriangleMesh& mesh, const Vec3& q) {
  constexpr Wide kTwelveBits = 4096;
  const auto term = [&](const Vec3& a, const Vec3& b, const Vec3& c) -> WithinQuad {
    const HalfAngle<Wide> wide = half_angle<Wide>(a, b, c, {q.x, q.y, q.z});
    // 10: the products that are summed. Not `>=`: 0 / 0, as above.
    const bool good = 10 * wide.cancellation() < kTwelveBits && !is_half_turn(wide, 0x1p-40L);
    return good ? WithinQuad{std::atan2(wide.im, wide.re), 0} : exact_term(a, b, c, q);
  };
  return static_cast<double>(sum_of(mesh, term).value);
}

WithinQuad winding_number_within(const TriangleMesh& mesh, const Vec3& q) {
  return sum_of(mesh, [&](const Vec3& a, const Vec3& b, const Vec3& c) { return exact_term(a, b, c, q); });
}

__float128 direct_winding_number_quad(const TriangleMesh& mesh, const Vec3& q) {
  return winding_number_within(mesh, q).value;
}

double perturbed_winding_number(const TriangleMesh& mesh, const Vec3& q, double step) {
  const Quad e = step;
  const Vector<Quad> moved{q.x + e, q.y + e * e, q.z + e * e * e};
  const auto term = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    return quad_term(a, b, c, moved, [] { return 0; });
  };
  return static_cast<double>(sum_of(mesh, term).value);
}

}  // namespace raycone::test
