// Whether the vertices of a contour lie where the proof of docs/method.md, "Surfaces", needs them.
#pragma once

#include <cstdint>
#include <span>

#include "core/data/vec3.h"
#include "core/surface/edge_points.h"
#include "core/surface/face_points.h"
#include "core/surface/surface_cells.h"

namespace raycone {

// How many vertices of contour(), before any merging, are not strictly inside of their edge, face or tetrahedron: less
// than half the margin from its border, or farther off it than a sixteenth of the margin. `tetrahedra`:
// ContouredSurface::tetrahedra. The same for any number of threads.
[[nodiscard]] std::uint64_t misplaced_vertices(std::span<const Vec3> vertices, const SurfaceCells& cells,
                                               const FacePoints& face_points, std::span<const std::uint64_t> tetrahedra,
                                               const SurfaceMargins& margins);

}  // namespace raycone
