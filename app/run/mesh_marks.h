// The flaws of a mesh in colour.
#pragma once

#include <vector>

#include "core/data/triangle_mesh.h"
#include "io/mesh/write_ply.h"

namespace raycone {

// The triangles of `mesh` in their order, grey, or yellow where `intersecting` is true; after them three-sided bars
// around its non-manifold (purple), inconsistent (blue) and exterior (orange) edges, for programs that show no edges.
// The edges themselves have these colours, too; an edge of several kinds that of the kind named first. Vertices have
// the colour of what they belong to. Precondition: as many `intersecting` as triangles.
[[nodiscard]] ColouredMesh marked_mesh(const TriangleMesh& mesh, const std::vector<bool>& intersecting);

}  // namespace raycone
