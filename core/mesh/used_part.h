// What triangles use of vertices.
#pragma once

#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/data/vec3.h"

namespace raycone {

// A mesh without the vertices that no triangle uses; the others in the order in which triangles come to them.
[[nodiscard]] TriangleMesh used_part(const std::vector<Vec3>& vertices, std::vector<Triangle> triangles);

}  // namespace raycone
