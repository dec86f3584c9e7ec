// What an evaluation can tell about each value.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace raycone {

// Of a block or batch of samples. Each span has the size and the order of the values.
struct Diagnostics {
  std::span<std::int64_t> crossings;   // n(q)
  std::span<std::int64_t> degenerate;  // how many edge sides were ties, which the symbolic perturbation decided
  std::span<std::uint8_t> on_surface;  // 1 on the surface; the value is that of the perturbed query there
  std::span<double> error_bound;       // rigorous, of |value - w|, turns (docs/method.md, "Error bound"); 0 if closed

  // The diagnostics of the samples [begin, begin + count).
  [[nodiscard]] Diagnostics part(std::size_t begin, std::size_t count) const {
    return {crossings.subspan(begin, count), degenerate.subspan(begin, count), on_surface.subspan(begin, count),
            error_bound.subspan(begin, count)};
  }

  void set_to_zero() const {
    std::ranges::fill(crossings, 0);
    std::ranges::fill(degenerate, 0);
    std::ranges::fill(on_surface, std::uint8_t{0});
    std::ranges::fill(error_bound, 0.0);
  }
};

}  // namespace raycone
