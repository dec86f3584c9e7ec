#include "core/certificate/component_signs.h"

#include "core/certificate/border_components.h"
#include "core/exact/volume_sign.h"

namespace raycone {

ComponentSigns component_signs(const TriangleMesh& mesh) {
  ComponentSigns signs{components_of(mesh), {}};
  for (const std::vector<Triangle>& part : triangles_of(signs.components, mesh))
    signs.of_component.push_back(volume_sign(part, mesh.vertices));
  return signs;
}

}  // namespace raycone
