// Where a segment meets a plane.
#pragma once

#include "core/data/vec3.h"

namespace raycone {

// Where the segment from p to q meets the plane of abc: 0 at p, 1 at q; within 2^-52. For all finite doubles: computed
// in integers, which takes some microseconds. Preconditions: p and q are not on the same side of the plane, nor both on
// it, and abc has an area. Thread-safe.
[[nodiscard]] double place_at_plane(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace raycone
