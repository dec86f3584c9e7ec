// What the PLY reader offers beside read_ply (io/mesh/read_mesh.h).
#pragma once

#include <vector>

#include "core/data/vec3.h"
#include "io/mesh/read_mesh.h"

namespace raycone {

// The vertices of a PLY file in their order, in any of the three encodings; faces need not be there and are not looked
// at. Throws InputError also for a coordinate that is not finite, naming the vertex and its line or byte.
[[nodiscard]] std::vector<Vec3> read_ply_vertices(const NamedBytes& source);

}  // namespace raycone
