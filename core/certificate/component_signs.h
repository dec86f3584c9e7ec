// Which way the components of a surface face.
#pragma once

#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/mesh/components.h"

namespace raycone {

struct ComponentSigns {
  Components components;
  std::vector<int> of_component;  // its volume_sign(): 1 outward, -1 inward, 0 flat

  [[nodiscard]] int of_vertex(std::uint32_t vertex) const { return of_component[components.of_vertex[vertex]]; }
};

// Exact. Precondition: each component is closed. Needs DefaultFloatingPoint.
[[nodiscard]] ComponentSigns component_signs(const TriangleMesh& mesh);

}  // namespace raycone
