// On which side of a closed surface its fronts are.
#pragma once

#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// The sign of the volume that triangles without exterior edges enclose: 1 where the fronts face outward, as a whole; -1
// inward; 0 where the volume is 0. Exact for all finite doubles: what floating point cannot vouch for is summed in
// integers, which takes some microseconds a triangle. Needs DefaultFloatingPoint. Thread-safe.
[[nodiscard]] int volume_sign(const std::vector<Triangle>& triangles, const std::vector<Vec3>& vertices);

}  // namespace raycone
