// z = s_a s_b + conj(P_a) P_b cancels where q is close to the inside of the edge, in any precision. Its argument is
// also that of z' = |N|^2 - (N x g)_x + i K N_x with N = p_a x p_b, g = |p_b| p_a - |p_a| p_b, K = |p_a||p_b| - p_a .
// p_b, which does not, given N to full relative precision. 113-bit arithmetic serves for its exponents (nothing here
// over- or underflows) and, with exact products and sums, for N.
#include "core/boundary/near_edge.h"

#include <cmath>

#include "core/exact/exact_determinant.h"
#include "core/exact/quad.h"

namespace raycone {
namespace {

Quad square_root(Quad x) {
  if (!(x > 0)) return 0;
  const Quad guess = std::sqrt(static_cast<long double>(x));  // same exponents, 64 bits
  return guess + (x - guess * guess) / (2 * guess);
}

// A vertex as seen from the query.
struct QuadVertex {
  QuadVec3 p;
  Quad norm;
  Quad s;  // |p| - p_x without cancellation
  explicit QuadVertex(const Vec3& v, const Vec3& q) : p(quad_difference(v, q)) {
    const Quad across = p.y * p.y + p.z * p.z;
    norm = square_root(p.x * p.x + across);
    s = p.x > 0 ? across / (norm + p.x) : norm - p.x;
  }
};

// A candidate for z with the sum of the absolute values of its terms: the smaller that is against |z|, the better.
struct Form {
  Quad re, im, terms;
  [[nodiscard]] Quad condition() const { return terms / (absolute(re) + absolute(im)); }
};

// Each term of a form is a product of at most four factors (norms are within 4 roundings of 2^-113, s within 10, sums
// and products 1 each): less than 40 in all, of the absolute terms, in Re and Im each, and as much again for
// second-order terms.
constexpr Quad kFormError = 160 * 0x1p-113;

Form plain_form(const QuadVertex& a, const QuadVertex& b, Quad n_x) {
  const Quad product = a.s * b.s, y = a.p.y * b.p.y, z = a.p.z * b.p.z;
  return {product + y + z, n_x, product + absolute(y) + absolute(z) + absolute(n_x)};
}

Form normal_form(const QuadVertex& a, const QuadVertex& b, const QuadVec3& n) {
  const Quad dot = a.p.x * b.p.x + a.p.y * b.p.y + a.p.z * b.p.z;
  const Quad k = a.norm * b.norm - dot;
  const Quad g_y = b.norm * a.p.y - a.norm * b.p.y, g_z = b.norm * a.p.z - a.norm * b.p.z;
  const Quad abs_y = b.norm * absolute(a.p.y) + a.norm * absolute(b.p.y);
  const Quad abs_z = b.norm * absolute(a.p.z) + a.norm * absolute(b.p.z);
  const Quad square = n.x * n.x + n.y * n.y + n.z * n.z;
  return {square - (n.y * g_z - n.z * g_y), k * n.x,
          square + absolute(n.y) * abs_z + absolute(n.z) * abs_y + (a.norm * b.norm + absolute(dot)) * absolute(n.x)};
}

}  // namespace

template <class Real>
NearEdgeFactor<Real> near_edge_factor(const Vec3& a, const Vec3& b, const Vec3& q) {
  const QuadVertex ca(a, q), cb(b, q);
  const QuadVec3 n = cross_of_differences(a, b, q);
  const Form plain = plain_form(ca, cb, n.x), normal = normal_form(ca, cb, n);
  // Written so that a form of 0 / 0, whose condition is NaN, loses.
  const Form& best = plain.condition() <= normal.condition() || !(normal.condition() >= 0) ? plain : normal;
  const Quad largest = absolute(best.re) > absolute(best.im) ? absolute(best.re) : absolute(best.im);
  return {{static_cast<Real>(best.re / largest), static_cast<Real>(best.im / largest)},
          static_cast<Real>(kFormError * best.condition())};
}

template NearEdgeFactor<double> near_edge_factor<double>(const Vec3&, const Vec3&, const Vec3&);
template NearEdgeFactor<Quad> near_edge_factor<Quad>(const Vec3&, const Vec3&, const Vec3&);

}  // namespace raycone
