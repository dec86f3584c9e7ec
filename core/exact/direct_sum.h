// The winding number by its definition: the sum of the solid angles of all triangles (Van Oosterom and Strackee 1983,
// eq. 8), in 113-bit arithmetic, and for triangles close to the query in integers of any size. For verification: it
// shares nothing with the evaluator, predicates included, and costs microseconds per triangle.
#pragma once

#include "core/data/triangle_mesh.h"
#include "core/exact/quad.h"

namespace raycone {

// A number and how far it may be off.
struct QuadWithin {
  Quad value;
  Quad error;
};

// w at any finite q of any finite mesh, however close, in turns of the full solid angle: on the surface the limit at
// q + (e1, e2, e3) for e1 >> e2 >> e3 > 0 (docs/method.md, "Exactness"). Off by less than 1e-20 per triangle, as the
// error says. A triangle that is closer than a millionth of its size takes some 0.1 ms. Thread-safe.
[[nodiscard]] QuadWithin perturbed_direct_sum(const TriangleMesh& mesh, const Vec3& q);

}  // namespace raycone
