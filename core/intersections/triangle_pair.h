// Whether two triangles of a mesh meet where they should not.
#pragma once

#include <array>

#include "core/data/vec3.h"

namespace raycone {

using Corners3 = std::array<Vec3, 3>;

// Whether the closed triangles have a point in common that lies on no vertex and on no edge of both. A vertex is of
// both where its position is, an edge where both its ends are. So neighbours may touch in what they share; two
// triangles of the same three corners overlap. A triangle of zero area is the segment or the point that its corners
// span. Symmetric, and the same for any order of corners. Exact for all finite doubles. Thread-safe; needs
// DefaultFloatingPoint.
[[nodiscard]] bool meet_beyond_shared(const Corners3& s, const Corners3& t);

}  // namespace raycone
