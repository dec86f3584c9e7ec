// What merging has gone away from, step by step.
#pragma once

#include <cstdint>
#include <vector>

#include "core/cells/surface_mesh.h"
#include "core/data/triangle_mesh.h"
#include "core/merging/merge_planes.h"

namespace raycone {

// A pull stays near the planes of the faces around a vertex, but when a face is gone its plane is, too: where planes
// turn little by little, pulls add up. Of the vertices of `surface` that were pulled into others and are farther than
// `most` (world units) from what is left, those that are farthest from a face of it, one for each, if they are at least
// half as far as the farthest one of all. `mesh`: the faces of `merged`, in their order; its points may have been
// moved. Uses the threads that ThreadLimit allows, and does not depend on their number.
[[nodiscard]] std::vector<std::uint32_t> left_behind(const SurfaceMesh& surface, const MergedFaces& merged,
                                                     const TriangleMesh& mesh, double most);

}  // namespace raycone
