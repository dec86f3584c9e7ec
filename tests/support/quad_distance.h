// Distances by brute force: all triangles, one after the other, in 113-bit precision and by other formulas than core's.
#pragma once

#include "core/data/triangle_mesh.h"

namespace raycone::test {

// From p to the nearest point of the closed triangles. Off by some 1e-33 of the coordinates, or by the height of
// triangles that are thinner than 1e-16 of their length.
[[nodiscard]] __float128 quad_distance(const TriangleMesh& mesh, const Vec3& p);

}  // namespace raycone::test
