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

// Edge i leads from corner i to the next; to_query[i] from corner i to the query.
struct Differences {
  std::array<DoubleDoubleVec3, 3> edges, to_query;

  [[nodiscard]] std::size_t longest_edge() const {
    const std::array<double, 3> squares{square(edges[0].rounded()), square(edges[1].rounded()),
                                        square(edges[2].rounded())};
    return static_cast<std::size_t>(std::ranges::max_element(squares) - squares.begin());
  }
};

// An edge that short is a point: beyond, products would underflow.
constexpr double kPoint = 1e-250;
// A triangle that thin beside its longest edge, 2^-56, is the segments of its edges.
constexpr double kThin = 0x1p-112;

double square_to_segment(const DoubleDoubleVec3& to_query, const DoubleDoubleVec3& edge) {
  const DoubleDouble edge_square = dot(edge, edge);
  if (edge_square.high < kPoint) return square(to_query.rounded());
  DoubleDouble along = dot(to_query, edge) / edge_square;
  if (along < kZero) along = kZero;
  if (kOne < along) along = kOne;
  return square((to_query - along * edge).rounded());
}

// Of the triangle's plane; infinity where its closest point is outside of the triangle.
double square_to_plane(const Differences& d) {
  const std::size_t longest = d.longest_edge();
  const DoubleDoubleVec3 &edge = d.edges[longest], &to_query = d.to_query[longest];
  const DoubleDoubleVec3 to_apex = DoubleDouble{-1.0} * d.edges[(longest + 2) % 3];
  const DoubleDouble edge_square = dot(edge, edge);
  if (edge_square.high < kPoint) return HUGE_VAL;
  const DoubleDouble apex = dot(to_apex, edge) / edge_square;
  const DoubleDoubleVec3 height = to_apex - apex * edge;
  const DoubleDouble height_square = dot(height, height);
  if (height_square.high < kThin * edge_square.high) return HUGE_VAL;
  const DoubleDouble along = dot(to_query, edge) / edge_square;
  const DoubleDoubleVec3 beside = to_query - along * edge;
  const DoubleDouble up = dot(beside, height) / height_square;
  const bool inside = !(up < kZero) && !(along < up * apex) && !(kOne - along < up * (kOne - apex));
  return inside ? square((beside - up * height).rounded()) : HUGE_VAL;
}

}  // namespace

double accurate_squared_distance(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const Differences d{{exact_difference(b, a), exact_difference(c, b), exact_difference(a, c)},
                      {exact_difference(p, a), exact_difference(p, b), exact_difference(p, c)}};
  double least = square_to_plane(d);
  if (least == HUGE_VAL) {
    for (std::size_t i = 0; i < 3; ++i) least = std::min(least, square_to_segment(d.to_query[i], d.edges[i]));
  }
  return least;
}

}  // namespace raycone
