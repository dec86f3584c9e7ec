// The closest point of the plane in coordinates along two edges; where it lies outside, the closest point of the edges
// beyond which it lies. Whatever rounding does to those coordinates, the point found is one of the triangle, so that
// distances are wrong to second order only, and where they are not small that is nothing. Those that are small beside
// the triangle, or whose triangle is thin, get more care. All constants: docs/method.md, "Distances".
#include "core/distance/triangle_distance.h"

#include <algorithm>
#include <limits>

#include "core/distance/accurate_distance.h"
#include "core/exact/double_double.h"

namespace raycone {
namespace {

constexpr double u = 0x1p-53;

// Squares of the height over the longest edge.
constexpr double kProper = 0x1p-8;
constexpr double kSlender = 4e-8;

double square(double x) { return x * x; }

// 0 where the square has lost bits: what is that short is taken for a point.
double inverse_or_zero(double x) { return x > 1e-290 ? 1.0 / x : 0.0; }

// p - a - v ab - w ac, off by some u of itself and u^2 of its terms.
Vec3 exact_rest(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p, double v, double w) {
  Vec3 rest;
  for (int axis = 0; axis < 3; ++axis) {
    const DoubleDouble from_a = exact_sum(p[axis], -a[axis]);
    const DoubleDouble ab = exact_sum(b[axis], -a[axis]), ac = exact_sum(c[axis], -a[axis]);
    const DoubleDouble along_ab = exact_product(v, ab.high), along_ac = exact_product(w, ac.high);
    const DoubleDouble less_ab = exact_sum(from_a.high, -along_ab.high);
    const DoubleDouble less_ac = exact_sum(less_ab.high, -along_ac.high);
    const double low = less_ab.low - along_ab.low - along_ac.low + from_a.low - v * ab.low - w * ac.low;
    rest[axis] = less_ac.high + (less_ac.low + low);
  }
  return rest;
}

}  // namespace

TriangleDistance::TriangleDistance(const Vec3& a, const Vec3& b, const Vec3& c)
    : corners_{a, b, c}, edges_{b - a, c - b, a - c} {
  const std::array<double, 3> squares{square(edges_[0]), square(edges_[1]), square(edges_[2])};
  for (std::size_t i = 0; i < 3; ++i) inverse_square_[i] = inverse_or_zero(squares[i]);
  const double longest = std::max({squares[0], squares[1], squares[2]});
  const Vec3 normal = cross(edges_[2], edges_[0]);  // ab x ac
  const double normal_square = square(normal);
  // Below, the normal's square has underflowed.
  constexpr double kTiny = 1e-130;
  const double full = longest > kTiny ? square(longest) : std::numeric_limits<double>::infinity();
  shape_ = normal_square >= kProper * full    ? Shape::kProper
           : normal_square >= kSlender * full ? Shape::kSlender
                                              : Shape::kFlat;
  sure_from_ = 0x1p-20 * longest;
  if (shape_ == Shape::kFlat) {
    sure_from_ = std::max(sure_from_, 4e12 * (longest > kTiny ? normal_square / longest : longest));
  } else {
    const double inverse = 1.0 / normal_square;
    to_v_ = inverse * cross(normal, edges_[2]);
    to_w_ = inverse * cross(normal, edges_[0]);
    if (shape_ == Shape::kSlender) sure_from_ = std::max(sure_from_, longest * square(1e-8 * full * inverse));
  }
  direction_from_ = std::max(sure_from_, 1e-250);
  // What is a few u off is right where it is a few u of the largest coordinate.
  const bool small = longest <= 0x1p-4;
  if (small && shape_ == Shape::kProper) sure_from_ = std::min(sure_from_, 0x1p-24 * square(longest));
  sure_from_ = std::max(sure_from_, 1e-250);
  sure_up_to_ = small ? square(u / 2) : -1.0;
}

double TriangleDistance::squared_to_edge(std::size_t i, const Vec3& p) const {
  const Vec3 from_corner = p - corners_[i];
  const double along = std::clamp(dot(from_corner, edges_[i]) * inverse_square_[i], 0.0, 1.0);
  return square(from_corner - along * edges_[i]);
}

double TriangleDistance::squared(const Vec3& p) const {
  const Vec3 from_a = p - corners_[0];
  const double v = dot(from_a, to_v_), w = dot(from_a, to_w_);
  const bool beyond_ab = w < 0.0;
  const bool beyond_bc = v + w > 1.0;
  const bool beyond_ca = v < 0.0;
  double least = std::numeric_limits<double>::infinity();
  if (!beyond_ab && !beyond_bc && !beyond_ca && shape_ != Shape::kFlat) {
    least = square(from_a - v * edges_[0] + w * edges_[2]);
  }
  const bool all_edges = shape_ != Shape::kProper;
  if (beyond_ab || all_edges) least = std::min(least, squared_to_edge(0, p));
  if (beyond_bc || all_edges) least = std::min(least, squared_to_edge(1, p));
  if (beyond_ca || all_edges) least = std::min(least, squared_to_edge(2, p));
  return least >= sure_from_ || least <= sure_up_to_ ? least : squared_with_care(p);
}

double TriangleDistance::squared_with_care(const Vec3& p) const {
  const Vec3 from_a = p - corners_[0];
  const double v = dot(from_a, to_v_), w = dot(from_a, to_w_);
  constexpr double kInside = 0x1p-10;  // far more than v and w are off
  if (shape_ != Shape::kProper || v < kInside || w < kInside || v + w > 1 - kInside) {
    return AccurateTriangle(corners_[0], corners_[1], corners_[2]).squared_distance(p);
  }
  // The rest is known to all digits, and what of it lies in the plane is the error of v and w.
  const Vec3 rest = exact_rest(corners_[0], corners_[1], corners_[2], p, v, w);
  return square(rest - dot(rest, to_v_) * edges_[0] + dot(rest, to_w_) * edges_[2]);
}

}  // namespace raycone
