// The distance from a point to a triangle where doubles do not do.
#pragma once

#include "core/data/vec3.h"

namespace raycone {

[[nodiscard]] inline double square(const Vec3& v) { return dot(v, v); }

// The square of the distance from p to the closed triangle, which may be degenerate: that distance is off by less than
// 1e-15 of itself or 1e-16 of the largest coordinate, which is 1/2 or more (docs/method.md, "Distances"). Coordinates
// below 2^400 in magnitude. Costs about a microsecond.
[[nodiscard]] double accurate_squared_distance(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p);

}  // namespace raycone
