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
  Rule rule;            // what is inside by its winding numbers
};

// Of a closed mesh: the components at which the rule ceases to hold or, where it has faults, or the rule holds in front
// of a component alone, its embedded_border(). None where there is none, or the mesh has more than `most` triangles and
// has to be cut. Also of a mesh whose boundary is empty but for how it is cut into edges. The same for any number of
// threads. Preconditions: as of closed_surface(). Needs DefaultFloatingPoint.
[[nodiscard]] std::optional<MeshBorder> mesh_border(const TriangleMesh& mesh, const NodeSet& inside,
                                                    const SurfaceOptions& options, std::size_t most);

}  // namespace raycone
