// Scenes of meshes as one mesh.
#pragma once

#include <string>

#include "core/data/triangle_mesh.h"
#include "io/mesh/affine_map.h"

namespace raycone {

// Appends `added` to `mesh`, its vertices placed by `placement`, its triangles turned over where that mirrors. `name`
// is for messages. Throws LimitError where indices do not suffice, and InputError about a corner that is no longer
// finite.
void append_placed(const TriangleMesh& added, const AffineMap& placement, const std::string& name, TriangleMesh& mesh);

}  // namespace raycone
