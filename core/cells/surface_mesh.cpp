#include "core/cells/surface_mesh.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/mesh/used_part.h"

namespace raycone {

bool has_holes(const SurfaceMesh& surface) {
  return std::ranges::find(surface.sources, kHole) != surface.sources.end();
}

void drop_gone(SurfaceMesh& surface) {
  std::size_t left = 0;
  for (std::size_t face = 0; face < surface.sources.size(); ++face) {
    const Triangle t = surface.mesh.triangles[face];
    if (is_gone(t)) continue;
    surface.sources[left] = surface.sources[face];
    surface.mesh.triangles[left++] = t;
  }
  surface.mesh.triangles.resize(left);
  surface.sources.resize(left);
  surface.mesh = used_part(surface.mesh.vertices, std::move(surface.mesh.triangles));
}

}  // namespace raycone
