// Gauss's rule of eight points on [0, 1].
#pragma once

#include <array>
#include <cstddef>

namespace raycone {

// The integral of a polynomial of degree 15 at most is the sum of `weight` times its values at `at`.
struct GaussRule {
  static constexpr std::size_t kPoints = 8;
  std::array<double, kPoints> at, weight;
};
[[nodiscard]] const GaussRule& gauss_rule();

}  // namespace raycone
