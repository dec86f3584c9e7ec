// Closed intervals of numbers.
#pragma once

#include <algorithm>

namespace raycone {

// From `lower` to `upper`; empty where they are not in this order, or NaN.
struct Interval {
  double lower, upper;
  [[nodiscard]] bool empty() const { return !(lower <= upper); }
};

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
