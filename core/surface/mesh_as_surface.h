// A mesh that needs no other surface: it is closed, and the lattice sees all of it.
#pragma once

#include <optional>

#include "core/data/triangle_mesh.h"
#include "core/surface/node_set.h"
#include "core/surface/surface.h"

namespace raycone {

// The mesh itself, where it is closed, 2-manifold and free of self-intersections: those of its components at which the
// rule ceases to hold. All of these must face outward then, and have the `inside` nodes, and no others, behind their
// fronts. Only if the lattice sees all of them (are_seen_by()), and there are no more than twelve triangles, once
// merged, to a cell with nodes of both kinds: walls and parts that are too thin for the lattice are dropped as ever,
// and of fine meshes a coarse lattice makes coarse surfaces. Faces of one plane are merged, then `options.simplify`
// holds, as closed_surface() does it. None otherwise, and where that function would do something else: where the set
// has a thickness, or no faces are to be merged. Lattices are not refused that are too fine for that one. The same for
// any number of threads. Preconditions: as of closed_surface().
[[nodiscard]] std::optional<FinishedSurface> mesh_as_surface(const TriangleMesh& mesh, const NodeSet& inside,
                                                             const SurfaceOptions& options);

}  // namespace raycone
