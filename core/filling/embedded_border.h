// The border of the set that a rule makes of a closed mesh with faults.
#pragma once

#include <optional>

#include "core/cells/node_set.h"
#include "core/cells/surface_mesh.h"
#include "core/data/triangle_mesh.h"
#include "core/surface/surface.h"

namespace raycone {

// The parts of faces at which the rule holds on one side alone: rule_border(), taken apart where parts of the set touch
// (take_apart()), by some 2^-30 voxel or some roundings, and rounded. So that nodes on faces there stay on their sides,
// parts move against the perturbation, where moves into their insides would not leave them there. It is closed,
// 2-manifold and free of self-intersections, and faces outward. Where rounding makes it pass through itself it is
// snapped (snap()), and the border of that is taken, a few times. Where that does not help, vertices at faults of the
// first border alone are moved other ways. None if there is nothing like that: of open meshes, and where faces touch in
// ways that no vertices can follow. The same for any number of threads. Preconditions: `mesh` is welded, its used
// vertices are finite. Needs DefaultFloatingPoint.
[[nodiscard]] std::optional<SurfaceMesh> embedded_border(const TriangleMesh& mesh, const NodeSet& inside,
                                                         const SurfaceOptions& options);

}  // namespace raycone
