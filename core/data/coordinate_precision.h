// How precisely coordinates are stored.
#pragma once

#include <vector>

#include "core/data/vec3.h"

namespace raycone {

// The numbers that coordinates are: doubles, or doubles that are floats, too.
enum class CoordinatePrecision { kDouble, kSingle };

// What a coordinate is off by at most once it is rounded, as a part of it.
[[nodiscard]] constexpr double relative_rounding(CoordinatePrecision precision) {
  return precision == CoordinatePrecision::kSingle ? 0x1p-24 : 0x1p-53;
}

// Each coordinate rounded to the nearest.
[[nodiscard]] Vec3 rounded_to(CoordinatePrecision precision, const Vec3& p);
void round_to(CoordinatePrecision precision, std::vector<Vec3>& points);

// Each coordinate rounded down, so that it is off by up to twice as much. Of two points that share a coordinate, as a
// node of a lattice and a face across an axis do, both still share it or the rounded one is below: where ties count as
// if the node were a little above, as they do for rules, it stays on its side.
[[nodiscard]] Vec3 rounded_down_to(CoordinatePrecision precision, const Vec3& p);
void round_down_to(CoordinatePrecision precision, std::vector<Vec3>& points);

}  // namespace raycone
