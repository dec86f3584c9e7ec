#include "core/mesh/mesh_flaws.h"

#include <algorithm>
#include <utility>

namespace raycone {

std::vector<EdgeUse> flawed_edges(const TriangleMesh& mesh) {
  std::vector<EdgeUse> flawed;
  for_each_edge(mesh, [&](const EdgeUse& use) {
    if (use.is_exterior() || use.is_nonmanifold()) flawed.push_back(use);  // what is inconsistent is exterior
  });
  return flawed;
}

std::vector<std::uint32_t> triangles_at(const TriangleMesh& mesh, const EdgeUse& edge) {
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    if (std::ranges::count(t, edge.low) > 0 && std::ranges::count(t, edge.high) > 0) triangles.push_back(i);
  }
  return triangles;
}

std::optional<std::array<std::uint32_t, 2>> first_duplicate(const TriangleMesh& mesh) {
  std::vector<std::pair<Triangle, std::uint32_t>> sorted;
  sorted.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    sorted.emplace_back(t, static_cast<std::uint32_t>(sorted.size()));
    std::ranges::sort(sorted.back().first);
  }
  std::ranges::sort(sorted);
  std::optional<std::array<std::uint32_t, 2>> found;
  for (std::size_t i = 1, first = 0; i < sorted.size(); ++i) {
    if (sorted[i].first != sorted[i - 1].first) {
      first = i;
    } else if (!found || sorted[i].second < (*found)[1]) {
      found = {sorted[first].second, sorted[i].second};
    }
  }
  return found;
}

}  // namespace raycone
