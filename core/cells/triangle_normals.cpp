#include "core/cells/triangle_normals.h"

#include "core/cells/unit_normal.h"
#include "core/machine/threads.h"

namespace raycone {

TriangleNormals::TriangleNormals(const TriangleMesh& mesh) : normals_(mesh.triangles.size()) {
  parallel_for_each(normals_.size(), 1024, [&](std::size_t triangle) {
    const Triangle& t = mesh.triangles[triangle];
    normals_[triangle] = unit_normal(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
  });
}

}  // namespace raycone
