// What is known of a value besides itself.
#pragma once

#include <cstdint>
#include <span>

namespace raycone {

// Of a block or batch of samples: every span has the values' size and order.
struct Diagnostics {
  std::span<std::int64_t> crossings;   // n(q)
  std::span<std::int64_t> degenerate;  // edge sides that were ties, decided by the symbolic perturbation
  std::span<std::uint8_t> on_surface;  // 1 on the surface, where the value is that of the perturbed query
  std::span<double> error_bound;  // of |w - true w| in turns, rigorous (docs/method.md, "Error bound"); 0 if closed
};

}  // namespace raycone
