#include "core/data/triangle_mesh.h"

namespace raycone {

Box bounding_box(const std::vector<Triangle>& triangles, const std::vector<Vec3>& vertices) {
  Box box = empty_box();
  for (const Triangle& triangle : triangles) {
    for (const std::uint32_t v : triangle) extend(box, vertices[v]);
  }
  return box;
}

}  // namespace raycone
