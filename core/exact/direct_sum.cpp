#include "core/exact/direct_sum.h"

#include <quadmath.h>

#include <algorithm>

#include "core/exact/exact_integers.h"

namespace raycone {
namespace {

using namespace exact;

const Quad kPi = 4 * atanq(1);

QuadVec3 relative_to(const QuadVec3& q, const Vec3& v) { return {v.x - q.x, v.y - q.y, v.z - q.z}; }

// Real and imaginary part sum ten products of three lengths, with 106 roundings in all (differences, norms, products,
// sums); 240 are paid for.
constexpr Quad kRoundings = 2 * 10 * 12 * kQuadRounding;

// Of the largest coordinate.
mp_bitcnt_t most_bits(const Corners& corners) {
  std::size_t bits = 1;
  for (const IntegerVec3& p : corners) {
    for (const mpz_class* x : {&p.x, &p.y, &p.z}) bits = std::max(bits, mpz_sizeinbase(x->get_mpz_t(), 2));
  }
  return bits;
}

// Determinants of two and three of B-bit integers are 0 or at least 1, and below 6 * 2^(2 B) and 6 * 2^(3 B). A step of
// 2^-(2 B + kMargin) units along x therefore changes no sign but that of 0, nor any angle by more than kSmall; nor
// does a step along y, as much smaller again, beside one along x, nor one along z beside that.
constexpr mp_bitcnt_t kMargin = 150;
constexpr Quad kSmall = 0x1p-100;

// The corners as the query sees them that has made these three steps, the last of which is the new unit.
Corners seen_after_steps(const Corners& corners, mp_bitcnt_t step) {
  Corners seen;
  const mpz_class one(1);
  for (std::size_t i = 0; i < 3; ++i) {
    const IntegerVec3& p = corners[i];
    seen[i] = {(p.x << (3 * step)) - (one << (2 * step)), (p.y << (3 * step)) - (one << step), (p.z << (3 * step)) - 1};
  }
  return seen;
}

// A number of at most 1 with 100 bits; what is too small for a double keeps its sign.
Quad as_quad(const mpf_class& x) {
  const double high = x.get_d();
  const mpf_class rest = x - high;
  return copysignq(Quad(high) + rest.get_d(), sgn(x));
}

// half_solid_angle() of the perturbed query, to 2^-100 wherever it is.
QuadWithin perturbed_half_solid_angle(const Vec3& va, const Vec3& vb, const Vec3& vc, const Vec3& q) {
  const Corners corners = as_integers({va, vb, vc}, q).corners;
  const mp_bitcnt_t bits = most_bits(corners), step = 2 * bits + kMargin;
  const auto [a, b, c] = seen_after_steps(corners, step);
  const mpz_class side = dot(a, cross(b, c));
  if (side == 0) return {0, 0};  // of zero area

  // Re z may be as small as the square of the last step, in units of a cube of lengths.
  const mp_bitcnt_t precision = 2 * (bits + 3 * step) + 2 * kMargin;
  const auto real = [&](const auto& x) { return mpf_class(x, precision); };
  const auto norm = [&](const IntegerVec3& p) { return real(sqrt(real(dot(p, p)))); };
  const mpf_class la = norm(a), lb = norm(b), lc = norm(c);
  mpf_class re = real(real(la * lb) * lc);
  re += real(real(dot(a, b)) * lc);
  re += real(real(dot(b, c)) * la);
  re += real(real(dot(c, a)) * lb);
  const mpf_class im = real(side), largest = real(std::max(real(abs(re)), real(abs(im))));
  return {atan2q(as_quad(real(im / largest)), as_quad(real(re / largest))), kSmall};
}

// Half the solid angle of the triangle at q, in (-pi, pi]. The error grows with the triangle's size over the distance
// of q from its edges, and is pi where no digit is left (closer than 1e-30), or not the sign of a half turn (q next to
// the triangle's inside).
QuadWithin half_solid_angle(const Vec3& va, const Vec3& vb, const Vec3& vc, const QuadVec3& q) {
  const QuadVec3 a = relative_to(q, va), b = relative_to(q, vb), c = relative_to(q, vc);
  const Quad la = sqrtq(dot(a, a)), lb = sqrtq(dot(b, b)), lc = sqrtq(dot(c, c));
  const Quad re = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  const Quad im = dot(a, cross(b, c));
  const Quad error = kRoundings * la * lb * lc / (fabsq(re) + fabsq(im));
  const bool half_turn = re < 0 && fabsq(im) <= error * (fabsq(re) + fabsq(im));
  if (!(error < 0.001) || half_turn) return {0, kPi};
  return {atan2q(im, re), error};
}

}  // namespace

QuadWithin perturbed_direct_sum(const TriangleMesh& mesh, const Vec3& q) {
  constexpr Quad kSharp = 1e-20;
  QuadWithin sum{0, 0};
  Quad magnitudes = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    QuadWithin term = half_solid_angle(a, b, c, {q.x, q.y, q.z});
    if (!(term.error < kSharp)) term = perturbed_half_solid_angle(a, b, c, q);
    sum.value += term.value;
    sum.error += term.error;
    magnitudes += absolute(term.value);
  }
  sum.error += static_cast<Quad>(mesh.triangles.size() + 2) * kQuadRounding * magnitudes;  // of the sum itself
  return {sum.value / (2 * kPi), sum.error / (2 * kPi)};
}

}  // namespace raycone
