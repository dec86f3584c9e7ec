// How precisely the vertices of a surface, or points that are drawn, are stored.
#pragma once

#include <vector>

#include "core/data/vec3.h"

namespace raycone {

// The numbers that coordinates are: doubles, or doubles that are floats, too.
enum class VertexPrecision { kDouble, kSingle };

// What a coordinate is off by at most once it is rounded, as a part of it.
[[nodiscard]] constexpr double relative_rounding(VertexPrecision precision) {
  return precision == VertexPrecision::kSingle ? 0x1p-24 : 0x1p-53;
}

// Each coordinate rounded to the nearest.
[[nodiscard]] Vec3 rounded_to(VertexPrecision precision, const Vec3& p);
void round_to(VertexPrecision precision, std::vector<Vec3>& points);

}  // namespace raycone
