// Triangles that a few rays along +x may cross, found by one pass over all triangles.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/crossings/crossings.h"
#include "core/data/triangle_mesh.h"
#include "core/data/vec3.h"

namespace raycone {

inline constexpr std::size_t kFewRays = 64;

// Appends each triangle whose closed box meets the ray {queries[i] + t x, t >= 0}, once for each such i, and possibly
// others. A pass takes some nanoseconds a triangle, where building a ProjectedGrid takes as long as a hundred passes,
// and much memory. Preconditions: at most kFewRays queries; all coordinates are finite. Thread-safe.
void find_candidates(const TriangleMesh& mesh, std::span<const Vec3> queries, std::vector<RayCandidate>& candidates);

}  // namespace raycone
