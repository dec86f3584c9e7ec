// Places that fill a unit cube evenly, however many there are.
#pragma once

#include <cmath>
#include <cstddef>

#include "core/data/vec3.h"

namespace raycone {

// Place number n, n >= 1, of a sequence of low discrepancy: multiples of the powers of 1 / 1.2207..., without whole
// parts (Roberts 2018). Coordinates in [0, 1).
inline Vec3 even_place(std::size_t n) {
  const double count = static_cast<double>(n);
  const Vec3 turns = count * Vec3{0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
  return turns - Vec3{std::floor(turns.x), std::floor(turns.y), std::floor(turns.z)};
}

}  // namespace raycone
