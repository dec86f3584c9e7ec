// Morton's curve through a box: neighbours on it are neighbours in space, as a rule.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "core/data/box.h"
#include "core/data/vec3.h"

namespace raycone {

// The lowest 21 bits, with two zeros between each and the next.
[[nodiscard]] constexpr std::uint64_t spread_bits(std::uint64_t x) {
  x &= 0x1F'FFFF;
  x = (x | x << 32U) & 0x1F'0000'0000'FFFF;
  x = (x | x << 16U) & 0x1F'0000'FF00'00FF;
  x = (x | x << 8U) & 0x100F'00F0'0F00'F00F;
  x = (x | x << 4U) & 0x10C3'0C30'C30C'30C3;
  return (x | x << 2U) & 0x1249'2492'4924'9249;
}

class SpaceCurve {
 public:
  // Through 2^(3 bits) cubes, bits <= 21, of a finite box, or of an empty one that is asked for no place. In a box of
  // less than 2^-1000 many points share a place.
  SpaceCurve(const Box& box, unsigned bits) : lower_(box.lower), cubes_(static_cast<double>(std::uint64_t{1} << bits)) {
    cubes_per_unit_ = cubes_ / std::max(longest_side(box), std::numeric_limits<double>::min());
  }

  // The place of the cube that a point is in, or the one next to it.
  [[nodiscard]] std::uint64_t place(const Vec3& p) const {
    std::uint64_t place = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double offset = (p[axis] - lower_[axis]) * cubes_per_unit_;
      const double cube = std::min(std::max(0.0, offset), cubes_ - 1);  // NaN: 0
      place |= spread_bits(static_cast<std::uint64_t>(cube)) << static_cast<unsigned>(axis);
    }
    return place;
  }

 private:
  Vec3 lower_;
  double cubes_, cubes_per_unit_;
};

}  // namespace raycone
