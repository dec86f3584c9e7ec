// The border of what is inside a mesh by a rule, as faces of its own.
#pragma once

#include <cstddef>
#include <optional>

#include "core/cells/node_set.h"
#include "core/cells/surface_mesh.h"
#include "core/data/rule.h"
#include "core/data/triangle_mesh.h"
#include "core/surface/surface.h"

namespace raycone {

struct MeshBorder {
  SurfaceMesh surface;  // closed, 2-manifold and free of self-intersections
  Rule rule;            // tells what is inside by the winding numbers of `surface`
};

// The border of what is inside a closed mesh. Where the mesh has no faults, it is the components at which the rule
// ceases to hold. Where it has faults, or the rule holds in front of a component alone, it is embedded_border(). The
// mesh may have exterior edges if its boundary is empty but for how it is cut into edges. None where there is no such
// border, where floats cannot hold the vertices, and where the mesh has more than `most` triangles and would have to be
// cut. The same for any number of threads. Preconditions: as of closed_surface(). Needs DefaultFloatingPoint.
[[nodiscard]] std::optional<MeshBorder> mesh_border(const TriangleMesh& mesh, const NodeSet& inside,
                                                    const SurfaceOptions& options, std::size_t most);

}  // namespace raycone
