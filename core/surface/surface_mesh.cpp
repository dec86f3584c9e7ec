#include "core/surface/surface_mesh.h"

#include <algorithm>
#include <cstddef>
#include <utility>

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

TriangleMesh used_part(const std::vector<Vec3>& vertices, std::vector<Triangle> triangles) {
  constexpr std::uint32_t kUnused = 0xFFFFFFFF;
  std::vector<std::uint32_t> number(vertices.size(), kUnused);
  std::uint32_t count = 0;
  for (Triangle& t : triangles) {
    for (std::uint32_t& corner : t) {
      if (number[corner] == kUnused) number[corner] = count++;
      corner = number[corner];
    }
  }
  TriangleMesh used{std::vector<Vec3>(count), std::move(triangles)};
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (number[v] != kUnused) used.vertices[number[v]] = vertices[v];
  }
  return used;
}

}  // namespace raycone
