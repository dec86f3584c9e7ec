// Oracle: intersections of triangles in rational numbers, by their definition.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/data/vec3.h"

namespace raycone::test {

// Whether the closed triangles have a point in common that lies on no vertex and no edge (by position) of both: the one
// is cut by the half-spaces of the other, and what is left compared with what they share.
[[nodiscard]] bool exactly_meet_beyond_shared(const std::array<Vec3, 3>& s, const std::array<Vec3, 3>& t);

// All such pairs, the lower index first, in increasing order. Looks at all pairs whose boxes meet.
[[nodiscard]] std::vector<std::array<std::uint32_t, 2>> exact_self_intersections(const TriangleMesh& mesh);

}  // namespace raycone::test
