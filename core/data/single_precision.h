// Points whose coordinates are 32-bit numbers.
#pragma once

#include <vector>

#include "core/data/vec3.h"

namespace raycone {

// As vertices in single precision are rounded: to the nearest.
[[nodiscard]] Vec3 rounded_to_float(const Vec3& p);
void round_to_float(std::vector<Vec3>& points);

}  // namespace raycone
