// The order in which exterior edges are evaluated.
#pragma once

#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/mesh/exterior_edges.h"

namespace raycone {

// The same edges by increasing |multiplicity|, those of one |multiplicity| strung into chains: an edge's `to` is the
// next one's `from` wherever possible. Edges may be turned around for that. Order and directions depend on the
// coordinates of the edges, and on the order given only where vertices are in one place.
[[nodiscard]] std::vector<ExteriorEdge> in_chains(const TriangleMesh& mesh, std::vector<ExteriorEdge> edges);

}  // namespace raycone
