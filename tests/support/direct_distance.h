// The oracle of distances: all triangles, one after the other, in 64-bit precision, by other formulas than core's.
#pragma once

#include "core/triangle_mesh.h"

namespace raycone::test {

// From p to the nearest point of the closed triangles.
[[nodiscard]] long double direct_distance(const TriangleMesh& mesh, const Vec3& p);

}  // namespace raycone::test
