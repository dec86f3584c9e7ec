// An open mesh closed as its winding numbers are.
#pragma once

#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/mesh/exterior_edges.h"

namespace raycone {

// The triangles of an open mesh, and behind them caps of its holes (core/boundary/caps.h): together they are closed.
// Preconditions: `mesh` is welded, its used vertices are finite; `edges` are its exterior edges. Needs
// DefaultFloatingPoint.
[[nodiscard]] TriangleMesh closed_by_caps(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges);

}  // namespace raycone
