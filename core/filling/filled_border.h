// The border of what is inside an open mesh by a rule, as faces of its own and others that close its holes.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/cells/surface_mesh.h"
#include "core/mesh/exterior_edges.h"
#include "core/surface/surface.h"

namespace raycone {

// The most triangles that there may be.
struct BorderLimits {
  std::size_t cut;   // in a mesh whose border has to be cut out
  std::size_t fill;  // without source, before the second border is taken
};

struct FilledBorder {
  SurfaceMesh surface;           // closed, 2-manifold and free of self-intersections, once around what is inside
  double left_out_of_all = 0.0;  // area of parts too thin for the lattice, as a fraction of the mesh's
};

// Closes the mesh by caps, takes the border of that (mesh_border()), fits what caps left to the threshold
// (fit_to_threshold()), and takes the border again. None where one of these steps finds nothing; where the mesh is
// mostly holes (more than 64 borders, more than a thousand caps, and more than a quarter as many caps as triangles);
// where caps alone would put more nodes on the wrong side than an eighth of those inside; and where the result is not
// along the threshold, or has lost what separates (fill_check). The same for any number of threads. Preconditions: as
// of closed_surface(); `edges` are the exterior edges of the mesh. Needs DefaultFloatingPoint.
[[nodiscard]] std::optional<FilledBorder> filled_border(const SurfaceInput& input,
                                                        const std::vector<ExteriorEdge>& edges,
                                                        const BorderLimits& limits);

}  // namespace raycone
