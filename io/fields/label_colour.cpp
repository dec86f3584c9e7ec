#include "io/fields/label_colour.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace raycone {

// Hues by the golden angle: those of neighbours are far apart, and none returns.
std::array<std::uint8_t, 3> label_colour(std::uint64_t label) {
  const double turns = static_cast<double>(label) * 0.6180339887498949;
  const double sixths = 6 * (turns - std::floor(turns));
  constexpr std::array kShifts{0.0, 4.0, 2.0};
  std::array<std::uint8_t, 3> colour{};
  for (std::size_t n = 0; n < colour.size(); ++n) {
    const double share = std::clamp(std::abs(std::fmod(sixths + kShifts[n], 6.0) - 3) - 1, 0.0, 1.0);
    colour[n] = static_cast<std::uint8_t>(std::lround(40 + 200 * share));
  }
  return colour;
}

}  // namespace raycone
