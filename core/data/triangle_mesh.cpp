#include "core/data/triangle_mesh.h"

#include <algorithm>

namespace raycone {

Box bounding_box(const TriangleMesh& mesh) {
  const Vec3& first = mesh.vertices[mesh.triangles.front()[0]];
  Box box{first, first};
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) {
      for (int axis = 0; axis < 3; ++axis) {
        box.lower[axis] = std::min(box.lower[axis], mesh.vertices[v][axis]);
        box.upper[axis] = std::max(box.upper[axis], mesh.vertices[v][axis]);
      }
    }
  }
  return box;
}

}  // namespace raycone
