// How precisely coordinates are stored.
#pragma once

#include <vector>

#include "core/data/vec3.h"

namespace raycone {

// The numbers that coordinates are: doubles, or doubles that are floats, too: the nearest ones, or the largest ones
// that are not above.
//
// A node of a lattice and a face across an axis may share a coordinate. If it is rounded to what is not above, the face
// has the node's coordinate or a lower one. Where ties count as if the node were a little above, as they do for rules,
// it stays on its side.
enum class CoordinatePrecision { kDouble, kSingle, kSingleNotAbove };

// What a coordinate is off by at most once it is rounded, as a part of it.
[[nodiscard]] constexpr double relative_rounding(CoordinatePrecision precision) {
  switch (precision) {
    case CoordinatePrecision::kDouble:
      return 0x1p-53;
    case CoordinatePrecision::kSingle:
      return 0x1p-24;
    case CoordinatePrecision::kSingleNotAbove:
      break;
  }
  return 0x1p-23;
}

// Each coordinate rounded. What floats cannot hold is infinite.
[[nodiscard]] Vec3 rounded_to(CoordinatePrecision precision, const Vec3& p);
void round_to(CoordinatePrecision precision, std::vector<Vec3>& points);

}  // namespace raycone
