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
// An edge from this square on is measured in double first.
constexpr double kMeasurable = 1e-200;
// A triangle that thin beside its longest edge, 2^-56, is the segments of its edges.
constexpr double kThin = 0x1p-112;

// What doubles may be off by, of the sum of the lengths of a query and an edge, both from one corner.
constexpr double kOff = 64 * 0x1p-53;

double sum_of_lengths(const Vec3& query, const Vec3& edge) {
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) sum += std::abs(query[axis]) + std::abs(edge[axis]);
  return sum;
}

// The segment from the origin along `edge` is not nearer to `query` than this.
double least_distance(const Vec3& query, const Vec3& edge) {
  const double edge_square = square(edge);
  if (!(edge_square > kMeasurable)) return 0.0;
  const double along = std::clamp(dot(query, edge) / edge_square, 0.0, 1.0);
  return std::max(norm(query - along * edge) - kOff * sum_of_lengths(query, edge), 0.0);
}

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

// Whether doubles are sure that the plane's closest point is on the other side of the longest edge than the triangle,
// or beyond its apex.
bool AccurateTriangle::is_beside(const Vec3& to_query) const {
  const Vec3 edge = edges_[longest_].rounded(), height = height_.rounded();
  const Vec3 beside = to_query - (dot(to_query, edge) / square(edge)) * edge;
  const double up = dot(beside, height) / square(height);
  const double off = kOff * sum_of_lengths(to_query, edge) / norm(height);
  return up < -off || up > 1.0 + off;
}

// Of the triangle's plane; infinity where its closest point is outside of the triangle.
double AccurateTriangle::square_to_plane(const Edges& to_query) const {
  if (is_thin_ || is_beside(to_query[longest_].rounded())) return HUGE_VAL;
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
  if (least != HUGE_VAL) return least;
  std::array<double, 3> from{};
  for (std::size_t i = 0; i < 3; ++i) from[i] = least_distance(to_query[i].rounded(), edges_[i].rounded());
  const auto first = static_cast<std::size_t>(std::ranges::min_element(from) - from.begin());
  least = square_to_segment(to_query[first], first);
  // The others, unless they are farther than rounding could hide.
  for (std::size_t i = 0; i < 3; ++i) {
    if (i != first && !(from[i] * from[i] > least * (1 + 1e-12)))
      least = std::min(least, square_to_segment(to_query[i], i));
  }
  return least;
}

}  // namespace raycone
