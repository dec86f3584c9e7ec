#include "core/filling/closed_by_caps.h"

#include <algorithm>
#include <cstdint>

#include "core/boundary/boundary.h"
#include "core/boundary/caps.h"

namespace raycone {

TriangleMesh closed_by_caps(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges) {
  const TriangleMesh caps = caps_and_strips(Boundary(mesh, edges));
  std::vector<std::uint32_t> ends;
  for (const ExteriorEdge& edge : edges) ends.insert(ends.end(), {edge.from, edge.to});
  const auto is_before = [](const Vec3& a, const Vec3& b) { return lexicographic_order(a, b) < 0; };
  const auto position = [&](std::uint32_t vertex) { return mesh.vertices[vertex]; };
  std::ranges::sort(ends, is_before, position);
  const auto end_at = [&](const Vec3& p) { return *std::ranges::lower_bound(ends, p, is_before, position); };
  std::vector<std::uint32_t> number(caps.vertices.size());
  std::ranges::transform(caps.vertices, number.begin(), end_at);
  TriangleMesh closed = mesh;
  for (const auto& [a, b, c] : caps.triangles) closed.triangles.push_back({number[a], number[c], number[b]});
  return closed;
}

}  // namespace raycone
