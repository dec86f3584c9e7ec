// What an evaluation can tell about each value.
#pragma once

#include <cstdint>
#include <span>

namespace raycone {

// Of a block or batch of samples. Each span has the size and the order of the values.
struct Diagnostics {
  std::span<std::int64_t> crossings;   // n(q)
  std::span<std::int64_t> degenerate;  // how many edge sides were ties, which the symbolic perturbation decided
  std::span<std::uint8_t> on_surface;  // 1 on the surface; the value is that of the perturbed query there
  std::span<double> error_bound;       // rigorous, of |value - w|, turns (docs/method.md, "Error bound"); 0 if closed
};

}  // namespace raycone
