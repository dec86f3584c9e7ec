// The closest point of the plane in coordinates along two edges; where it lies outside, the closest point of the edges
// beyond which it lies. Whatever rounding does to those coordinates, the point found is one of the triangle, so that
// distances are wrong to second order only.
#include "core/triangle_distance.h"

#include <algorithm>
#include <limits>

namespace raycone {
namespace {

// Sine squared of the angle at a below which a triangle is taken for a needle: coordinates along its edges then have
// fewer than half their digits, and all edges are looked at.
constexpr double kNeedle = 1e-8;

double square(const Vec3& v) { return dot(v, v); }

// 0 where the inverse could overflow: what is that short is taken for a point.
double inverse_or_zero(double x) { return x > 1e-290 ? 1.0 / x : 0.0; }

}  // namespace

TriangleDistance::TriangleDistance(const Vec3& a, const Vec3& b, const Vec3& c)
    : corners_{a, b, c},
      edges_{b - a, c - b, a - c},
      ab_ab_(square(edges_[0])),
      ab_ac_(-dot(edges_[0], edges_[2])),
      ac_ac_(square(edges_[2])) {
  for (std::size_t i = 0; i < 3; ++i) inverse_square_[i] = inverse_or_zero(square(edges_[i]));
  const double determinant = square(cross(edges_[0], edges_[2]));
  inverse_determinant_ = inverse_or_zero(determinant);
  proper_ = inverse_determinant_ > 0.0 && determinant > kNeedle * ab_ab_ * ac_ac_;
}

double TriangleDistance::squared_to_edge(std::size_t i, const Vec3& p) const {
  const Vec3 from_corner = p - corners_[i];
  const double along = std::clamp(dot(from_corner, edges_[i]) * inverse_square_[i], 0.0, 1.0);
  return square(from_corner - along * edges_[i]);
}

double TriangleDistance::squared(const Vec3& p) const {
  const Vec3& ab = edges_[0];
  const Vec3 ac = -1.0 * edges_[2];
  const Vec3 from_a = p - corners_[0];
  const double along_ab = dot(from_a, ab), along_ac = dot(from_a, ac);
  const double v = (ac_ac_ * along_ab - ab_ac_ * along_ac) * inverse_determinant_;
  const double w = (ab_ab_ * along_ac - ab_ac_ * along_ab) * inverse_determinant_;
  const bool beyond_ab = w<0.0, beyond_bc = v + w> 1.0, beyond_ca = v < 0.0;
  double least = std::numeric_limits<double>::infinity();
  if (!beyond_ab && !beyond_bc && !beyond_ca && inverse_determinant_ > 0.0) {
    least = square(from_a - v * ab - w * ac);
    if (proper_) return least;
  }
  if (beyond_ab || !proper_) least = std::min(least, squared_to_edge(0, p));
  if (beyond_bc || !proper_) least = std::min(least, squared_to_edge(1, p));
  if (beyond_ca || !proper_) least = std::min(least, squared_to_edge(2, p));
  return least;
}

}  // namespace raycone
