// On which side of a closed surface its fronts are.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// The sign of the volume that triangles without exterior edges enclose: 1 where the fronts face outward, as a whole; -1
// inward; 0 where the volume is 0. Exact for all finite doubles: what floating point cannot vouch for is summed in
// integers, which takes some microseconds a triangle. Needs DefaultFloatingPoint. Thread-safe.
[[nodiscard]] int volume_sign(const std::vector<Triangle>& triangles, const std::vector<Vec3>& vertices);

// The same of a sum in doubles of a product of three for each triangle, where that is sure, else 0. `terms`: the sum of
// the magnitudes of all products; in each of them kVolumeUnderflow was added to a product of two.
[[nodiscard]] int sure_volume_sign(double sum, double terms, std::uint64_t triangles);
inline constexpr double kVolumeUnderflow = 0x1p-1000;  // far more than a product loses that is below all doubles

}  // namespace raycone
