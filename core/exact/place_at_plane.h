// Where a segment meets a plane.
#pragma once

#include "core/data/vec3.h"

namespace raycone {

// How far from p to q, as a part of the way, the segment meets the plane of abc; within 2^-52. For all finite doubles:
// it is found in integers, which takes some microseconds. Preconditions: p and q are not on the same side of the plane,
// nor both on it, and abc has an area. Thread-safe.
[[nodiscard]] double place_at_plane(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace raycone
