#include "core/mesh/components.h"

#include <algorithm>
#include <numeric>

namespace raycone {

Components components_of(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0U);
  std::vector<std::uint8_t> used(mesh.vertices.size(), 0);  // bits would wait for each other
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  // Parents are lower than their children, so that a pass by increasing vertices finds all roots.
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    if (parent[a] == parent[b]) return;
    const std::uint32_t i = root(a), j = root(b);
    parent[std::max(i, j)] = std::min(i, j);
  };
  constexpr std::size_t kAhead = 16;  // triangles: their vertices may be anywhere in memory
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (i + kAhead < mesh.triangles.size()) {
      for (const std::uint32_t v : mesh.triangles[i + kAhead]) __builtin_prefetch(&parent[v], 1);
    }
    const Triangle& t = mesh.triangles[i];
    join(t[0], t[1]);
    join(t[0], t[2]);
    for (const std::uint32_t v : t) used[v] = 1;
  }
  Components components{0, std::vector<std::uint32_t>(mesh.vertices.size(), Components::kUnused)};
  for (std::size_t v = 0; v < parent.size(); ++v) {
    if (used[v] == 0) continue;
    components.of_vertex[v] = parent[v] == v ? components.count++ : components.of_vertex[parent[v]];
  }
  return components;
}

}  // namespace raycone
