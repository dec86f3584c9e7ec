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

// The same from a sum in doubles: of six times a signed volume for each triangle. 0 where rounding may have changed the
// sign. `terms`: the sum of the magnitudes of all products, where kVolumeUnderflow was added to each product of two
// factors before the third.
[[nodiscard]] int sure_volume_sign(double sum, double terms, std::uint64_t triangles);
inline constexpr double kVolumeUnderflow = 0x1p-1000;  // far more than a product loses that is below all doubles

}  // namespace raycone
