#include "core/surface/component_signs.h"

#include "core/exact/volume_sign.h"

namespace raycone {

ComponentSigns component_signs(const TriangleMesh& mesh) {
  ComponentSigns signs{components_of(mesh), {}};
  std::vector<std::vector<Triangle>> parts(signs.components.count);
  for (const Triangle& t : mesh.triangles) parts[signs.components.of_vertex[t[0]]].push_back(t);
  for (const std::vector<Triangle>& part : parts) signs.of_component.push_back(volume_sign(part, mesh.vertices));
  return signs;
}

}  // namespace raycone
