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

AccurateTriangle::AccurateTriangle(const Vec3& a, const Vec3& b, const Vec3& c) : parts_{} {
  Parts& t = parts_;
  t.corners = {a, b, c};
  t.edges = {exact_difference(b, a), exact_difference(c, b), exact_difference(a, c)};
  std::array<double, 3> squares;
  for (std::size_t i = 0; i < 3; ++i) {
    t.edge_squares[i] = dot(t.edges[i], t.edges[i]);
    squares[i] = square(rounded(t.edges[i]));
  }
  t.longest = static_cast<std::size_t>(std::ranges::max_element(squares) - squares.begin());
  const DoubleDoubleVec3& longest = t.edges[t.longest];
  const DoubleDouble& longest_square = t.edge_squares[t.longest];
  const DoubleDoubleVec3 to_apex = DoubleDouble{-1.0} * t.edges[(t.longest + 2) % 3];
  t.is_thin = longest_square.high < kPoint;
  if (t.is_thin) return;
  t.apex = dot(to_apex, longest) / longest_square;
  t.height = to_apex - t.apex * longest;
  t.height_square = dot(t.height, t.height);
  t.is_thin = t.height_square.high < kThin * longest_square.high;
}

double AccurateTriangle::square_to_segment(const DoubleDoubleVec3& to_query, std::size_t edge) const {
  if (parts_.edge_squares[edge].high < kPoint) return square(rounded(to_query));
  DoubleDouble along = dot(to_query, parts_.edges[edge]) / parts_.edge_squares[edge];
  if (along < kZero) along = kZero;
  if (kOne < along) along = kOne;
  return square(rounded(to_query - along * parts_.edges[edge]));
}

// Whether doubles are sure that the plane's closest point is on the other side of the longest edge than the triangle,
// or beyond its apex.
bool AccurateTriangle::is_beside(const Vec3& to_query) const {
  const Vec3 edge = rounded(parts_.edges[parts_.longest]), height = rounded(parts_.height);
  const Vec3 beside = to_query - (dot(to_query, edge) / square(edge)) * edge;
  const double up = dot(beside, height) / square(height);
  const double off = kOff * sum_of_lengths(to_query, edge) / norm(height);
  return up < -off || up > 1.0 + off;
}

// Of the triangle's plane; infinity where its closest point is outside of the triangle.
double AccurateTriangle::square_to_plane(const Edges& to_query) const {
  if (parts_.is_thin || is_beside(rounded(to_query[parts_.longest]))) return HUGE_VAL;
  const DoubleDoubleVec3& edge = parts_.edges[parts_.longest];
  const DoubleDouble along = dot(to_query[parts_.longest], edge) / parts_.edge_squares[parts_.longest];
  const DoubleDoubleVec3 beside = to_query[parts_.longest] - along * edge;
  const DoubleDouble up = dot(beside, parts_.height) / parts_.height_square;
  const bool inside = !(up < kZero) && !(along < up * parts_.apex) && !(kOne - along < up * (kOne - parts_.apex));
  return inside ? square(rounded(beside - up * parts_.height)) : HUGE_VAL;
}

double AccurateTriangle::squared_distance(const Vec3& p) const {
  const Edges to_query{exact_difference(p, parts_.corners[0]), exact_difference(p, parts_.corners[1]),
                       exact_difference(p, parts_.corners[2])};
  double least = square_to_plane(to_query);
  if (least != HUGE_VAL) return least;
  std::array<double, 3> from{};
  for (std::size_t i = 0; i < 3; ++i) from[i] = least_distance(rounded(to_query[i]), rounded(parts_.edges[i]));
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
