// Signs of numbers that are rounded.
#pragma once

namespace raycone {

// The sign of a number whose `value` is off by less than `trust`: -1 or 1; 0 where it may have any sign, or either
// argument is NaN.
[[nodiscard]] inline int sure_sign(double value, double trust) {
  return static_cast<int>(value > trust) - static_cast<int>(value < -trust);
}

}  // namespace raycone
