#include "tests/support/direct_winding_number.h"

#include <quadmath.h>

#include <cmath>

namespace raycone::test {
namespace {

using Quad = __float128;

// Cancellation beyond this leaves no digit of 113 bits: a triangle of zero area seen from its own line, whose term is 0
// / 0.
const Quad kNothingLeft = 1e30;
const Quad kTwoPi = 8 * atanq(1);

long double square_root(long double x) { return std::sqrt(x); }
long double arc_tangent(long double y, long double x) { return std::atan2(y, x); }
Quad square_root(Quad x) { return sqrtq(x); }
Quad arc_tangent(Quad y, Quad x) { return atan2q(y, x); }

template <class Real>
Real absolute(Real x) {
  return x < 0 ? -x : x;
}

template <class Real>
struct Vector {
  Real x, y, z;
};

template <class Real>
Vector<Real> minus(const Vec3& v, const Vector<Real>& q) {
  return {Real(v.x) - q.x, Real(v.y) - q.y, Real(v.z) - q.z};
}

template <class Real>
Real dot(const Vector<Real>& a, const Vector<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Half the solid angle of a triangle, as an argument, and how much its real and imaginary parts cancel.
template <class Real>
struct Term {
  Real half_angle;
  Real cancellation;  // sum of absolute terms / |z|
};

template <class Real>
Term<Real> term(const Vec3& va, const Vec3& vb, const Vec3& vc, const Vector<Real>& q) {
  const Vector<Real> a = minus(va, q), b = minus(vb, q), c = minus(vc, q);
  const Real la = square_root(dot(a, a)), lb = square_root(dot(b, b)), lc = square_root(dot(c, c));
  const Real ab = dot(a, b) * lc, bc = dot(b, c) * la, ca = dot(c, a) * lb;
  const Real re = la * lb * lc + ab + bc + ca;
  const Real im = a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
  const Real magnitude = absolute(re) + absolute(im);
  return {arc_tangent(im, re), 10 * la * lb * lc / magnitude};
}

template <class Visit>
void for_each_triangle(const TriangleMesh& mesh, const Visit& visit) {
  for (const Triangle& t : mesh.triangles) visit(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
}

Quad sum_in_quad(const TriangleMesh& mesh, const Vector<Quad>& q) {
  Quad sum = 0;
  for_each_triangle(mesh, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    const Term<Quad> t = term<Quad>(a, b, c, q);
    if (t.cancellation < kNothingLeft) sum += t.half_angle;  // a triangle of zero area seen from its own line: 0 / 0
  });
  return sum;
}

}  // namespace

double direct_winding_number(const TriangleMesh& mesh, const Vec3& q) {
  constexpr long double kTwelveBits = 4096;
  const Vector<long double> extended{q.x, q.y, q.z};
  const Vector<Quad> quad{q.x, q.y, q.z};
  Quad sum = 0;
  for_each_triangle(mesh, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    const Term<long double> t = term<long double>(a, b, c, extended);
    if (t.cancellation < kTwelveBits) {
      sum += t.half_angle;
      return;
    }
    const Term<Quad> careful = term<Quad>(a, b, c, quad);
    if (careful.cancellation < kNothingLeft) sum += careful.half_angle;
  });
  return static_cast<double>(sum / kTwoPi);
}

__float128 direct_winding_number_quad(const TriangleMesh& mesh, const Vec3& q) {
  return sum_in_quad(mesh, {q.x, q.y, q.z}) / kTwoPi;
}

double perturbed_winding_number(const TriangleMesh& mesh, const Vec3& q, double step) {
  const Quad e = step;
  return static_cast<double>(sum_in_quad(mesh, {q.x + e, q.y + e * e, q.z + e * e * e}) / kTwoPi);
}

}  // namespace raycone::test
