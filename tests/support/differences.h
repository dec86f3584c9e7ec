// How far two results are apart.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace raycone::test {

// The larger of two differences; infinity where the second is NaN, which std::max would pass over.
[[nodiscard]] inline double larger_difference(double largest, double difference) {
  return std::isnan(difference) ? std::numeric_limits<double>::infinity() : std::max(largest, difference);
}

// Infinity where the sizes differ, and where only one of two values is a number.
[[nodiscard]] inline double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = larger_difference(largest, std::abs(a[i] - b[i]));
  return largest;
}

}  // namespace raycone::test
