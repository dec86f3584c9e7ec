#include "core/certificate/border_components.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>

#include "core/cells/surface_mesh.h"
#include "core/data/keep_where.h"
#include "core/evaluation/winding_number.h"
#include "core/exact/volume_sign.h"
#include "core/mesh/exterior_edges.h"
#include "core/mesh/used_part.h"

namespace raycone {
namespace {

// The vertex that is the last one by x, then y, then z.
Vec3 last_vertex(const std::vector<Triangle>& triangles, const std::vector<Vec3>& vertices) {
  const auto is_before = [](const Vec3& a, const Vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); };
  Vec3 last = vertices[triangles.front()[0]];
  for (const Triangle& t : triangles) {
    for (const std::uint32_t v : t) last = std::max(last, vertices[v], is_before);
  }
  return last;
}

// The winding numbers around each component. A sample at its last vertex counts as moved to where nothing else of the
// component is, so it is outside of it: its winding number is what the others make of it.
std::vector<double> winding_numbers_around(const std::vector<std::vector<Triangle>>& components,
                                           const TriangleMesh& mesh) {
  std::vector<double> around(components.size(), 0.0);
  if (components.size() == 1) return around;  // there are no others
  std::vector<Vec3> points(components.size());
  std::ranges::transform(components, points.begin(),
                         [&](const std::vector<Triangle>& part) { return last_vertex(part, mesh.vertices); });
  const std::vector<ExteriorEdge> none;
  WindingNumberEvaluator(mesh, {.edges = &none}).evaluate(points, around);
  return around;
}

}  // namespace

std::vector<std::vector<Triangle>> triangles_of(const Components& components, const TriangleMesh& mesh) {
  std::vector<std::vector<Triangle>> parts(components.count);
  for (const Triangle& t : mesh.triangles) parts[components.of_vertex[t[0]]].push_back(t);
  return parts;
}

void keep_components(SurfaceMesh& surface, const Components& components, const std::vector<bool>& kept) {
  std::vector<Triangle>& triangles = surface.mesh.triangles;
  const auto is_kept = [&](std::size_t face) { return kept[components.of_vertex[triangles[face][0]]]; };
  keep_where(is_kept, triangles, surface.sources);
  surface.mesh = used_part(surface.mesh.vertices, std::move(triangles));
}

bool keep_border(SurfaceMesh& surface, const Rule& rule) {
  const Components components = components_of(surface.mesh);
  const std::vector<std::vector<Triangle>> parts = triangles_of(components, surface.mesh);
  const std::vector<double> around = winding_numbers_around(parts, surface.mesh);
  std::vector<bool> is_border(parts.size());
  for (std::size_t n = 0; n < parts.size(); ++n) {
    const int sign = volume_sign(parts[n], surface.mesh.vertices);
    const double front = sign > 0 ? around[n] : around[n] - 1.0, behind = front + 1.0;
    if (sign == 0 || (holds(rule, front) && !holds(rule, behind))) return false;
    is_border[n] = !holds(rule, front) && holds(rule, behind);
  }
  keep_components(surface, components, is_border);
  return !surface.sources.empty();
}

}  // namespace raycone
