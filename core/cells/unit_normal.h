// The unit normal of a triangle.
#pragma once

#include "core/data/vec3.h"

namespace raycone {

// Within 1e-15 unless the triangle is a needle; 0 where it has no area. Thread-safe.
[[nodiscard]] Vec3 unit_normal(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace raycone
