// Closed intervals of numbers.
#pragma once

#include <algorithm>
#include <limits>

namespace raycone {

// From `lower` to `upper`; empty where they are not in this order, or NaN.
struct Interval {
  double lower, upper;
  [[nodiscard]] bool empty() const { return !(lower <= upper); }
};

// Of no number: extended by one it is that.
inline constexpr Interval kEmptyInterval{std::numeric_limits<double>::infinity(),
                                         -std::numeric_limits<double>::infinity()};

inline void extend(Interval& a, double by) {
  a.lower = std::min(a.lower, by);
  a.upper = std::max(a.upper, by);
}

inline Interval intersection(const Interval& a, const Interval& b) {
  return {std::max(a.lower, b.lower), std::min(a.upper, b.upper)};
}

// The smallest one that holds both.
inline Interval hull(const Interval& a, const Interval& b) {
  if (a.empty()) return b;
  return b.empty() ? a : Interval{std::min(a.lower, b.lower), std::max(a.upper, b.upper)};
}

inline Interval widened(const Interval& a, double by) { return {a.lower - by, a.upper + by}; }

}  // namespace raycone
