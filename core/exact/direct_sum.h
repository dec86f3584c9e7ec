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

// Half the solid angle of the triangle at q, in (-pi, pi]. The error grows with the triangle's size over the distance
// of q from its edges, and is pi where no digit is left (closer than 1e-30), or not the sign of a half turn (q next to
// the triangle's inside).
// `side`, where not 0, is the exact plane_side() of q and settles that sign.
[[nodiscard]] QuadWithin half_solid_angle(const Vec3& a, const Vec3& b, const Vec3& c, const QuadVec3& q, int side = 0);

// w at q in turns of the full solid angle. Not defined on the surface. Triangles of zero area count nothing.
[[nodiscard]] QuadWithin direct_winding_number(const TriangleMesh& mesh, const QuadVec3& q);

// The same at any finite q of any finite mesh, however close: on the surface the limit at q + (e1, e2, e3) for
// e1 >> e2 >> e3 > 0 (docs/method.md, "Exactness"). Off by less than 1e-20 per triangle, as the error says. A triangle
// that is closer than a millionth of its size takes some 0.1 ms. Thread-safe.
[[nodiscard]] QuadWithin perturbed_direct_sum(const TriangleMesh& mesh, const Vec3& q);

}  // namespace raycone
