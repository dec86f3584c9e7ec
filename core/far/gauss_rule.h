// Gauss's rules on [0, 1].
#pragma once

#include <array>
#include <cstddef>

namespace raycone {

// The integral of a polynomial of degree 2 `points` - 1 at most is the sum of `weight` times its values at `at`.
struct GaussRule {
  static constexpr std::size_t kMost = 11;  // points
  std::size_t points;
  std::array<double, kMost> at, weight;
};
// That of 1 to kMost points. Thread-safe.
[[nodiscard]] const GaussRule& gauss_rule(std::size_t points);

}  // namespace raycone
