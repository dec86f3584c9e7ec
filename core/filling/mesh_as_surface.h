// A mesh that needs no other surface: the lattice sees all of the border that it has, and its holes can be filled.
#pragma once

#include <optional>

#include "core/surface/surface.h"

namespace raycone {

// The border of what is inside a mesh, made of the mesh's own faces; none where a contour does better.
// Of a mesh without exterior edges, or with none but at cracks of some roundings, it is mesh_border(). Of others it is
// filled_border(): caps close the holes, fit_to_threshold() divides the caps, and the border is cut out. It has the
// `inside` nodes, and no others, behind its fronts. Components that the lattice does not see (sights_of()) are left
// out. Faces of one plane are merged; then `options.simplify` holds, as closed_surface() does it.
// None where the lattice sees a component only in part, or where there are more than twelve triangles, once merged, to
// a mixed cell: so walls and parts that are too thin for the lattice are dropped as ever, and coarse lattices make
// coarse surfaces of fine meshes. None where what fills holes is not along the threshold, or cuts off what separates;
// where the set has a thickness; and where no faces are to be merged. Unlike closed_surface(), this does not refuse
// lattices that are too fine. The same for any number of threads. Preconditions: as of closed_surface().
[[nodiscard]] std::optional<FinishedSurface> mesh_as_surface(const SurfaceInput& input);

}  // namespace raycone
