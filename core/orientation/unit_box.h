// Coordinates for sums that are not exact.
#pragma once

#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// The vertices moved and scaled so that those of the faces are in [0, 1]^3, up to rounding, and fill it along one axis
// at least by half. Others are moved along, and may be anywhere. Equal vertices stay equal.
[[nodiscard]] std::vector<Vec3> in_unit_box(const std::vector<Vec3>& vertices,
                                            const std::vector<const std::vector<Triangle>*>& faces);

}  // namespace raycone
