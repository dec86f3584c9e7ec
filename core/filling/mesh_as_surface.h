// A mesh that needs no other surface: the lattice sees all of the border that it has, and its holes can be filled.
#pragma once

#include <optional>

#include "core/surface/surface.h"

namespace raycone {

// The mesh itself, where it is closed, 2-manifold and free of self-intersections: those of its components at which the
// rule ceases to hold. If it has faults, or the rule holds in front of a component alone, its embedded_border(). Open
// ones may be closed but for cracks of some roundings. Others are closed by caps first; fit_to_threshold() divides
// these, and the border of that is cut out. That must have the `inside` nodes, and no others, behind its fronts.
// Components that the lattice does not see are left out (sights_of()); if it sees others in part, or there are more
// than twelve triangles, once merged, to a cell with nodes of both kinds, there is no surface: walls and parts that are
// too thin for the lattice are dropped as ever, and of fine meshes a coarse lattice makes coarse surfaces. Faces of one
// plane are merged, then `options.simplify` holds, as closed_surface() does it. None otherwise, and where that function
// would do something else: where the set has a thickness, or no faces are to be merged, and where what fills holes is
// not along the threshold, or cuts off what separates. Lattices are not refused that are too fine for that one. The
// same for any number of threads. Preconditions: as of closed_surface().
[[nodiscard]] std::optional<FinishedSurface> mesh_as_surface(const SurfaceInput& input);

}  // namespace raycone
