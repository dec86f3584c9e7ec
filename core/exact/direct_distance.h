// The distance to a mesh by its definition: the least of those to all triangles, in exact integer arithmetic and
// rounded to 113 bits at the end. For verification: it shares nothing with the evaluator, and costs nanoseconds per
// triangle whose box is farther than the nearest corner, some 4 us for each of the others.
#pragma once

#include "core/data/triangle_mesh.h"
#include "core/exact/quad.h"

namespace raycone {

// From q to the nearest point of the closed triangles, whatever their shape: segments and points, too; infinity for an
// empty mesh. Off by at most 2^-110 of the distance. Any finite coordinates; 0 exactly on the surface. Thread-safe.
[[nodiscard]] Quad direct_distance(const TriangleMesh& mesh, const Vec3& q);

}  // namespace raycone
