// The oracle: generalized winding numbers as the plain sum of the solid angles of all triangles (Van Oosterom &
// Strackee 1983, eq. 8), in extended precision. Shares no code with core but the mesh's type: its half turns are
// decided by exact_predicates.h, and it is not the direct sum of --verify.
#pragma once

#include "core/data/triangle_mesh.h"

namespace raycone::test {

// A number and how far it may be off.
struct WithinQuad {
  __float128 value = 0;
  __float128 error = 0;
};

// w at q, in turns of the full solid angle (sum of solid angles / 4 pi). Each triangle's term is computed with 64 bits,
// and again with 113 bits where cancellation would cost the former more than 12 of them (q close to the triangle). In
// all good to 1e-14 (the sign of a half turn is the exact predicate's), for queries no closer to an edge than 1e-14 of
// its length; not defined on the surface.
[[nodiscard]] double direct_winding_number(const TriangleMesh& mesh, const Vec3& q);

// The same with 113 bits throughout. The error is that of the sum's terms, 1/2 for each whose 113 bits tell nothing (q
// on the triangle, or closer than some 1e-30 to its edges); the sum's own roundings are far below.
[[nodiscard]] WithinQuad winding_number_within(const TriangleMesh& mesh, const Vec3& q);

// Its value alone.
[[nodiscard]] __float128 direct_winding_number_quad(const TriangleMesh& mesh, const Vec3& q);

// The same at the query moved by (e1, e2, e3), e1 = step, e2 = step^2, e3 = step^3, all in 113 bits: what the symbolic
// perturbation stands for, made actual.
[[nodiscard]] double perturbed_winding_number(const TriangleMesh& mesh, const Vec3& q, double step);

}  // namespace raycone::test
