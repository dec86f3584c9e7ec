// Cuts one polygon into triangles.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/data/vec3.h"

namespace raycone {

// Triangles, as indices into `corners`, that cover the polygon once in the projection along `direction`, which is not
// zero, and have its boundary: where corners at one place are one, the triangles' directed edges sum to the polygon's,
// opposite ones cancelled. Absent where the polygon is not simple there (core/mesh/polygons.h), two corners at
// different places project to one point, or there are 2^29 corners. The result is the same from whichever corner the
// polygon starts, but for which of the corners at one place is named. Exact for all finite doubles; thread-safe; needs
// DefaultFloatingPoint. Time n log n, where thousands of edges overlap on one line at most n^1.5; memory n.
[[nodiscard]] std::optional<std::vector<std::array<std::uint32_t, 3>>> cut_polygon(std::span<const Vec3> corners,
                                                                                   const Vec3& direction);

}  // namespace raycone
