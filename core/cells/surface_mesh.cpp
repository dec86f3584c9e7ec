#include "core/cells/surface_mesh.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/data/keep_where.h"
#include "core/mesh/used_part.h"

namespace raycone {

bool has_holes(const SurfaceMesh& surface) {
  return std::ranges::find(surface.sources, kHole) != surface.sources.end();
}

void drop_gone(SurfaceMesh& surface) {
  std::vector<Triangle>& triangles = surface.mesh.triangles;
  keep_where([&](std::size_t face) { return !is_gone(triangles[face]); }, triangles, surface.sources);
  surface.mesh = used_part(surface.mesh.vertices, std::move(triangles));
}

}  // namespace raycone
