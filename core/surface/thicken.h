// A set that has grown by a distance from triangles.
#pragma once

#include <vector>

#include "core/cells/edge_points.h"
#include "core/cells/edge_roots.h"
#include "core/cells/node_set.h"
#include "core/cells/surface_cells.h"
#include "core/distance/distance.h"

namespace raycone {

// Adds the nodes that are no farther than `thickness` (world units, positive) from the mesh.
void insert_near(NodeSet& nodes, const DistanceEvaluator& distance, double thickness);

// As edge_points(), for the set where the rule holds or that is no farther than `thickness` (world units) from the
// mesh. Where the distance ends the set, `source` is the nearest triangle.
[[nodiscard]] std::vector<EdgePoint> thick_edge_points(const RuleAlong& rule, const DistanceEvaluator& distance,
                                                       double thickness, const SurfaceCells& cells, double margin);

}  // namespace raycone
