// Samples that share one ray.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "core/data/vec3.h"

namespace raycone {

// The queries (x, y, z) for all x of xs, ascending: their rays along +x lie on one line. A single query is a row of
// one.
struct Row {
  double y = 0.0;
  double z = 0.0;
  std::span<const double> xs;
  double samples_per_unit = 0.0;  // about 1 / spacing: where to look first; 0 where unknown

  [[nodiscard]] Vec3 query(std::size_t i) const { return {xs[i], y, z}; }
};

// Number of values of the ascending `xs` below `value`. Fast where they are about evenly spaced.
[[nodiscard]] inline std::size_t count_below(std::span<const double> xs, double samples_per_unit, double value) {
  constexpr int kPatience = 4;  // steps from the first guess; rounding takes one
  const double guess = (value - xs.front()) * samples_per_unit;
  std::size_t i = guess > 0.0 ? static_cast<std::size_t>(std::min(guess, static_cast<double>(xs.size()))) : 0;
  for (int step = 0; step < kPatience; ++step) {
    if (i < xs.size() && xs[i] < value) {
      ++i;
    } else if (i > 0 && !(xs[i - 1] < value)) {
      --i;
    } else {
      return i;
    }
  }
  return static_cast<std::size_t>(std::lower_bound(xs.begin(), xs.end(), value) - xs.begin());
}

// Number of values of the ascending `xs` that are not above `value`.
[[nodiscard]] inline std::size_t count_up_to(std::span<const double> xs, double samples_per_unit, double value) {
  std::size_t i = count_below(xs, samples_per_unit, value);
  while (i < xs.size() && xs[i] == value) ++i;
  return i;
}

}  // namespace raycone
