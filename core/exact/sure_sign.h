// Signs of numbers that are rounded.
#pragma once

namespace raycone {

// Of a number that is off by less than `trust`: -1, 1, or 0 where it may have any sign, or either is NaN.
[[nodiscard]] inline int sure_sign(double value, double trust) {
  return static_cast<int>(value > trust) - static_cast<int>(value < -trust);
}

}  // namespace raycone
