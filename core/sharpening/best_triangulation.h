// Triangles that a polygon in a plane is cut into.
#pragma once

#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/data/vec3.h"

namespace raycone {

// Cuts a polygon (three corners or more) into triangles of its corners, by number, so that the worst triangle is as
// good as can be: the least area over the square of the longest side is largest. `front`: the normal of length 1 on the
// side from which the corners go around counter-clockwise. All triangles show their fronts there: where the polygon
// does not meet itself, they do not overlap. None where some triangle would have to be turned over. Dynamic programming
// over the polygon's diagonals (Klincsek 1980): time n^3, memory n^2. Thread-safe.
[[nodiscard]] std::vector<Triangle> best_triangulation(const std::vector<Vec3>& corners, const Vec3& front);

}  // namespace raycone
