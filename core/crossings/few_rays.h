// Triangles that a few rays along +x may cross, found by one pass over all triangles.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "core/crossings/crossings.h"
#include "core/data/triangle_mesh.h"
#include "core/data/vec3.h"

namespace raycone {

inline constexpr std::size_t kFewRays = 64;

// Calls visit() for each triangle whose closed box meets the ray {queries[i] + t x, t >= 0}, once for each such i, and
// possibly for others. A pass takes some nanoseconds a triangle; a ProjectedGrid takes much memory, and about sixty
// times as long to build. Preconditions: at most kFewRays queries; all coordinates are finite. Thread-safe.
void for_each_candidate(const TriangleMesh& mesh, std::span<const Vec3> queries,
                        const std::function<void(const RayCandidate&)>& visit);

}  // namespace raycone
