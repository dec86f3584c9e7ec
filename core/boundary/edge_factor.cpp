#include "core/boundary/edge_factor.h"

#include <algorithm>
#include <cmath>

#include "core/exact/quad.h"

namespace raycone {
namespace {

// |P|^2 within these bounds has lost nothing to underflow and cannot overflow, nor can products of two; nor, where
// |p_x| is below the last one, can x^2 or s, which is above 2^-1002 then.
constexpr double kSmallest = 0x1p-800;
constexpr double kLargest = 0x1p800;
constexpr double kLargestX = 0x1p200;

// A vertex as seen from the query.
struct DoubleVertex {
  double x, y, z, square, s;
  DoubleVertex(const Vec3& v, const Vec3& q) : x(v.x - q.x), y(v.y - q.y), z(v.z - q.z), square(y * y + z * z) {
    const double norm = std::sqrt(x * x + square);
    s = x > 0.0 ? square / (norm + x) : norm - x;
  }
  [[nodiscard]] bool ordinary() const { return square > kSmallest && square < kLargest && std::abs(x) < kLargestX; }
};

Factor<double> scaled(const Factor<double>& f) {
  const int exponent = -std::ilogb(std::max(std::abs(f.re), std::abs(f.im)));
  return {std::scalbn(f.re, exponent), std::scalbn(f.im, exponent)};
}

// |Im| is |D|.
Factor<double> generic_factor(const Vec3& a, const Vec3& b, const Vec3& q) {
  const EdgeDeterminant d = edge_determinant(a, b, q);
  const DoubleVertex ca(a, q), cb(b, q);
  const double product_of_s = ca.s * cb.s;
  const Factor<double> plain{product_of_s + (ca.y * cb.y + ca.z * cb.z), d.value};
  const double magnitude = std::abs(plain.re) + std::abs(plain.im);
  const bool trusted = ca.ordinary() && cb.ordinary() && magnitude > kNearEdge * product_of_s &&
                       magnitude > kSmallest && magnitude < kLargest;
  return trusted ? plain : near_edge_factor<double>(a, b, q).factor;
}

bool on_one_side(double a, double b, double of) { return (a < of && b < of) || (a > of && b > of); }

// For an edge with D = 0 that does not project to a point (docs/method.md, "Exact zeros"): the line through the query
// along the ray meets the edge's line. Re and |Im| of a number with the argument of z_ab(q), of any magnitude, each
// rounded once to Real; the sign of Im is that of edge_side(). Nothing where the argument is 0. Real: long double or
// Quad, for their exponents: nothing over- or underflows.
template <class Real>
std::optional<Factor<Real>> tied_factor(const Vec3& a, const Vec3& b, const Vec3& q) {
  if (on_one_side(a.y, b.y, q.y) || on_one_side(a.z, b.z, q.z)) return std::nullopt;  // as most are
  const Real ay = Real(a.y) - Real(q.y), az = Real(a.z) - Real(q.z);
  const Real by = Real(b.y) - Real(q.y), bz = Real(b.z) - Real(q.z);
  const auto factor = [](Real re, Real im) { return Factor<Real>{re, im < 0 ? -im : im}; };
  // The ray passes through an end ahead, (s, P) = (0, -1); if q lies at it or beyond, the argument is 0.
  if (ay == 0 && az == 0) return a.x > q.x ? std::optional(factor(-by, bz)) : std::nullopt;
  if (by == 0 && bz == 0) return b.x > q.x ? std::optional(factor(-ay, az)) : std::nullopt;
  // P_a and P_b lie on one line through 0, which is between them.
  return meeting_side(a, b, q) > 0 ? std::optional(factor(-1, 0)) : std::nullopt;
}

// tied_factor(), max(|re|, |im|) in [1, 2).
std::optional<Factor<double>> rounded_tied_factor(const Vec3& a, const Vec3& b, const Vec3& q) {
  const std::optional<Factor<long double>> f = tied_factor<long double>(a, b, q);
  if (!f) return std::nullopt;
  const int exponent = -std::ilogb(std::max(std::abs(f->re), f->im));
  return Factor<double>{static_cast<double>(std::scalbn(f->re, exponent)),
                        static_cast<double>(std::scalbn(f->im, exponent))};
}

}  // namespace

std::optional<Factor<double>> edge_factor(const Vec3& a, const Vec3& b, const Vec3& q, const EdgeSide& side) {
  if (side.sign == 0) return std::nullopt;  // projects to a point
  const std::optional<Factor<double>> f =
      side.tie ? rounded_tied_factor(a, b, q) : std::optional(generic_factor(a, b, q));
  if (!f) return std::nullopt;
  return scaled({f->re, std::copysign(f->im, side.sign)});
}

std::optional<NearEdgeFactor<Quad>> close_edge_factor(const Vec3& from, const ChainStep& step, const Vec3& q) {
  const EdgeSide side = edge_side(from, step.to, q);
  if (side.sign == 0) return std::nullopt;
  NearEdgeFactor<Quad> result{{}, 0};
  if (side.tie) {
    const std::optional<Factor<Quad>> f = tied_factor<Quad>(from, step.to, q);
    if (!f) return std::nullopt;
    result.factor = *f;
  } else {
    result = near_edge_factor<Quad>(from, step.to, q);
  }
  Quad& im = result.factor.im;
  im = im == 0 ? 0 : absolute(im);
  if ((step.reversed ? -side.sign : side.sign) < 0) im = -im;
  return result;
}

}  // namespace raycone
