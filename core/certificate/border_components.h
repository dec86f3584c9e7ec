// Components of a surface, and which of them are the border of what is inside by a rule.
#pragma once

#include <vector>

#include "core/cells/surface_mesh.h"
#include "core/data/rule.h"
#include "core/data/triangle_mesh.h"
#include "core/mesh/components.h"

namespace raycone {

// The triangles of each component.
[[nodiscard]] std::vector<std::vector<Triangle>> triangles_of(const Components& components, const TriangleMesh& mesh);

// Leaves only the components that are `kept` (by their numbers), in their order, and their vertices.
void keep_components(SurfaceMesh& surface, const Components& components, const std::vector<bool>& kept);

// Leaves the components at which the rule ceases to hold: it holds behind them, and not in front. Returns true if that
// is the whole border. False, and the surface stays, where the rule holds in front of a component and not behind it, or
// a component has no volume; false also where no component is left. Precondition: the mesh is closed and free of
// self-intersections.
[[nodiscard]] bool keep_border(SurfaceMesh& surface, const Rule& rule);

}  // namespace raycone
