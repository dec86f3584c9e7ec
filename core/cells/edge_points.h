// The points of a surface on the edges of a lattice.
#pragma once

#include <cstdint>
#include <vector>

#include "core/cells/cell_triangles.h"
#include "core/cells/edge_roots.h"
#include "core/cells/surface_cells.h"
#include "core/cells/surface_mesh.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

struct EdgePoint {
  Vec3 position;
  std::int32_t source = kHole;  // the triangle by which the edge leaves the set
};

// For each mixed edge, by its number, the point nearest to its inside end where the rule ceases to hold: on the first
// triangle that carries the winding number across, or where it passes a threshold by itself, as it does in holes.
// Points stay away from the ends of their edge by the margin, a fraction of the edge, and are moved no farther for it.
// `rule`, `cells` and `triangles` are of this mesh. The same for any number of threads.
[[nodiscard]] std::vector<EdgePoint> edge_points(const TriangleMesh& mesh, const RuleAlong& rule,
                                                 const SurfaceCells& cells, const CellTriangles& triangles,
                                                 double margin);

}  // namespace raycone
