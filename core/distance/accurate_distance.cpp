// Gram and Schmidt's coordinates in some 100 bits: along the longest edge, and across it, which nothing loses digits in
// however thin the triangle is. Differences of coordinates are exact.
#include "core/distance/accurate_distance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/exact/double_double.h"

namespace raycone {
namespace {

constexpr DoubleDouble kZero{0.0}, kOne{1.0};

// An edge that short is a point: beyond, products would underflow.
constexpr double kPoint = 1e-250;
// A triangle that thin beside its longest edge, 2^-56, is the segments of its edges.
constexpr double kThin = 0x1p-112;

}  // namespace

AccurateTriangle::AccurateTriangle(const Vec3& a, const Vec3& b, const Vec3& c)
    : corners_{a, b, c},
      edges_{exact_difference(b, a), exact_difference(c, b), exact_difference(a, c)},
      edge_squares_{dot(edges_[0], edges_[0]), dot(edges_[1], edges_[1]), dot(edges_[2], edges_[2])} {
  const std::array<double, 3> squares{square(edges_[0].rounded()), square(edges_[1].rounded()),
                                      square(edges_[2].rounded())};
  longest_ = static_cast<std::size_t>(std::ranges::max_element(squares) - squares.begin());
  const DoubleDoubleVec3 to_apex = DoubleDouble{-1.0} * edges_[(longest_ + 2) % 3];
  is_thin_ = edge_squares_[longest_].high < kPoint;
  if (is_thin_) return;
  apex_ = dot(to_apex, edges_[longest_]) / edge_squares_[longest_];
  height_ = to_apex - apex_ * edges_[longest_];
  height_square_ = dot(height_, height_);
  is_thin_ = height_square_.high < kThin * edge_squares_[longest_].high;
}

double AccurateTriangle::square_to_segment(const DoubleDoubleVec3& to_query, std::size_t edge) const {
  if (edge_squares_[edge].high < kPoint) return square(to_query.rounded());
  DoubleDouble along = dot(to_query, edges_[edge]) / edge_squares_[edge];
  if (along < kZero) along = kZero;
  if (kOne < along) along = kOne;
  return square((to_query - along * edges_[edge]).rounded());
}

// Of the triangle's plane; infinity where its closest point is outside of the triangle.
double AccurateTriangle::square_to_plane(const Edges& to_query) const {
  if (is_thin_) return HUGE_VAL;
  const DoubleDoubleVec3& edge = edges_[longest_];
  const DoubleDouble along = dot(to_query[longest_], edge) / edge_squares_[longest_];
  const DoubleDoubleVec3 beside = to_query[longest_] - along * edge;
  const DoubleDouble up = dot(beside, height_) / height_square_;
  const bool inside = !(up < kZero) && !(along < up * apex_) && !(kOne - along < up * (kOne - apex_));
  return inside ? square((beside - up * height_).rounded()) : HUGE_VAL;
}

double AccurateTriangle::squared_distance(const Vec3& p) const {
  const Edges to_query{exact_difference(p, corners_[0]), exact_difference(p, corners_[1]),
                       exact_difference(p, corners_[2])};
  double least = square_to_plane(to_query);
  if (least == HUGE_VAL) {
    for (std::size_t i = 0; i < 3; ++i) least = std::min(least, square_to_segment(to_query[i], i));
  }
  return least;
}

}  // namespace raycone
