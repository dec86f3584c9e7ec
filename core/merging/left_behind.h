// What merging has gone away from, step by step.
#pragma once

#include <cstdint>
#include <vector>

#include "core/cells/surface_mesh.h"
#include "core/data/triangle_mesh.h"
#include "core/merging/merge_planes.h"

namespace raycone {

// Vertices of `surface` that merging has pulled too far from it. A pull stays near the planes of the faces around a
// vertex; but a face that is gone takes its plane with it, so that where planes turn little by little, pulls add up.
// Looked at are vertices that were pulled into others and are farther than `most` (world units) from what is left; each
// belongs to the face that is nearest to it. Returns the farthest vertex of each face, if it is at least half as far as
// the farthest of all. `mesh`: the faces of `merged`, in their order; its points may have been moved. Uses the threads
// that ThreadLimit allows; the same for any number of them.
[[nodiscard]] std::vector<std::uint32_t> left_behind(const SurfaceMesh& surface, const MergedFaces& merged,
                                                     const TriangleMesh& mesh, double most);

}  // namespace raycone
