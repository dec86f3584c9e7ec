// The gradient of the winding number by its definition: the sum over all sides of all triangles, in 113-bit arithmetic.
// For verification: it knows nothing of exterior edges.
#pragma once

#include "core/data/triangle_mesh.h"
#include "core/exact/quad.h"

namespace raycone {

struct DirectGradient {
  QuadVec3 value{0, 0, 0};  // turns per unit
  Quad magnitude = 0;       // the sum of the lengths of what was added: rounding is to be judged by it
};

// At any finite q. Sides that two triangles run through in opposite directions cancel exactly; a side adds nothing
// where q is on its line. Some 9 us per triangle. Thread-safe.
[[nodiscard]] DirectGradient direct_gradient(const TriangleMesh& mesh, const Vec3& q);

}  // namespace raycone
