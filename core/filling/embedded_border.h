// The border of the set that a rule makes of a closed mesh with faults.
#pragma once

#include <optional>

#include "core/cells/node_set.h"
#include "core/cells/surface_mesh.h"
#include "core/data/triangle_mesh.h"
#include "core/surface/surface.h"

namespace raycone {

// The rule_border() of a mesh, made closed, 2-manifold and free of self-intersections; it faces outward. Where parts of
// the set touch, they are taken apart (take_apart()) by some 2^-30 voxels or some roundings. Moves into their insides
// may leave nodes that lie on faces there on the wrong side: then parts move against the perturbation. Where rounding
// makes the border pass through itself, it is snapped (snap()) and its own border is taken, a few times. Where that
// does not help, vertices of the first border are moved other ways, at its faults alone.
// None where no such border is found: of open meshes, and where faces touch in ways that no vertices can follow. The
// same for any number of threads. Preconditions: `mesh` is welded, its used vertices are finite. Needs
// DefaultFloatingPoint.
[[nodiscard]] std::optional<SurfaceMesh> embedded_border(const TriangleMesh& mesh, const NodeSet& inside,
                                                         const SurfaceOptions& options);

}  // namespace raycone
