#include "core/mesh/components.h"

#include <algorithm>

#include "core/mesh/disjoint_sets.h"

namespace raycone {

// Each vertex gets the label of the lower one that it is linked to: labels are as many as vertices that have no lower
// neighbour, few nearly always. The triangles then say which labels are one component. Some of them tell nearly all of
// that: the others then find equal labels at their corners (M. Sutton, T. Ben-Nun, A. Barak 2018).
Components components_of(const TriangleMesh& mesh, const VertexLinks& links) {
  Components components{0, std::vector<std::uint32_t>(mesh.vertices.size(), Components::kUnused)};
  std::vector<std::uint32_t>& label = components.of_vertex;
  for (std::size_t v = 0; v < label.size(); ++v) {
    if (!links.is_used(v)) continue;
    const std::uint32_t lower = links.lower(v);
    // Not by branches, which are a coin toss in some meshes.
    const std::uint32_t is_new = lower == v ? 1 : 0;
    label[v] = components.count * is_new + label[lower] * (1 - is_new);
    components.count += is_new;
  }
  if (components.count < 2) return components;
  constexpr std::size_t kSome = 4;
  for (const std::size_t step : {kSome, std::size_t{1}}) {
    DisjointSets<> sets(components.count);
    for (std::size_t i = 0; i < mesh.triangles.size() && sets.count() > 1; i += step) {
      const Triangle& t = mesh.triangles[i];
      const std::uint32_t a = label[t[0]], b = label[t[1]], c = label[t[2]];
      if (((a ^ b) | (a ^ c)) == 0) continue;
      sets.join(a, b);
      sets.join(a, c);
    }
    if (sets.count() == components.count) continue;
    components.count = static_cast<std::uint32_t>(sets.count());
    const std::vector<std::uint32_t> numbers = sets.indices();
    for (std::uint32_t& l : label) {
      if (l != Components::kUnused) l = numbers[l];
    }
    if (components.count == 1) break;
  }
  return components;
}

Components components_of(const TriangleMesh& mesh) {
  DisjointSets<> sets(mesh.vertices.size());
  std::vector<std::uint8_t> used(mesh.vertices.size(), 0);  // bits would wait for each other
  constexpr std::size_t kAhead = 16;                        // triangles: their vertices may be anywhere in memory
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (i + kAhead < mesh.triangles.size()) {
      for (const std::uint32_t v : mesh.triangles[i + kAhead]) sets.prefetch(v);
    }
    const Triangle& t = mesh.triangles[i];
    sets.join(t[0], t[1]);
    sets.join(t[0], t[2]);
    for (const std::uint32_t v : t) used[v] = 1;
  }
  const auto unused = static_cast<std::size_t>(std::ranges::count(used, 0));
  const auto is_used = [&](std::size_t v) { return used[v] != 0; };
  return {static_cast<std::uint32_t>(sets.count() - unused), sets.indices(is_used, Components::kUnused)};
}

}  // namespace raycone
