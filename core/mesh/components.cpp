#include "core/mesh/components.h"

#include <numeric>
#include <utility>

namespace raycone {

Components components_of(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Triangle& t : mesh.triangles) {
    const std::uint32_t first = root(t[0]);
    parent[root(t[1])] = first;
    parent[root(t[2])] = first;
  }
  Components components{0, std::vector<std::uint32_t>(mesh.vertices.size(), Components::kUnused)};
  for (const Triangle& t : mesh.triangles) {
    std::uint32_t& of_root = components.of_vertex[root(t[0])];
    if (of_root == Components::kUnused) of_root = components.count++;
    for (const std::uint32_t v : t) components.of_vertex[v] = of_root;
  }
  return components;
}

}  // namespace raycone
