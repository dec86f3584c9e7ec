// Whether the vertices of a contour lie where the proof of docs/method.md, "Surfaces", needs them.
#pragma once

#include <cstdint>
#include <span>

#include "core/cells/edge_points.h"
#include "core/cells/surface_cells.h"
#include "core/contour/face_points.h"
#include "core/data/coordinate_precision.h"
#include "core/data/vec3.h"

namespace raycone {

// What contour() is made of, and the apexes that it makes; also points that no triangle has.
struct ContourPoints {
  std::span<const EdgePoint> edges;
  std::span<const Vec3> faces, apexes;
  CoordinatePrecision precision = CoordinatePrecision::kDouble;  // of the vertices that they become
};

// How many of these points, before any merging, are not inside of their edge, face or tetrahedron: they are nearer to
// its border than half the margin, or farther off it than a sixteenth of the margin. `face_points` says which faces the
// points are of; `tetrahedra`: ContouredSurface::tetrahedra; `margin`: SurfaceInCells::margin. The same for any number
// of threads.
[[nodiscard]] std::uint64_t misplaced_vertices(const ContourPoints& points, const SurfaceCells& cells,
                                               const FacePoints& face_points, std::span<const std::uint64_t> tetrahedra,
                                               double margin);

}  // namespace raycone
