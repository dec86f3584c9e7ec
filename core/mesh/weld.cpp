#include "core/mesh/weld.h"

#include <cassert>
#include <cmath>
#include <utility>

#include "core/machine/floating_point.h"
#include "core/mesh/equal_vertices.h"
#include "core/mesh/near_vertices.h"

namespace raycone {
namespace {

Vec3 with_positive_zeros(const Vec3& p) { return {p.x + 0.0, p.y + 0.0, p.z + 0.0}; }

// Keeps the first of bitwise equal vertices, in their order. Returns for each vertex the one that stands for it.
std::vector<std::uint32_t> weld_exactly(std::vector<Vec3>& vertices) {
  std::vector<std::uint32_t> representative = first_equal_vertices(vertices);
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (representative[i] == i) {
      vertices[kept] = vertices[i];
      representative[i] = kept++;
    } else {
      representative[i] = representative[representative[i]];
    }
  }
  vertices.resize(kept);
  return representative;
}

}  // namespace

TriangleMesh weld(TriangleMesh mesh, const Weld& how) {
  const DefaultFloatingPoint guard;  // flushing to zero would move what is tiny
  for (Vec3& p : mesh.vertices) p = with_positive_zeros(p);
  if (how.mode == WeldMode::kNone) return mesh;
  std::vector<std::uint32_t> representative = weld_exactly(mesh.vertices);
  if (how.mode == WeldMode::kDistance) {
    assert(how.distance > 0.0 && std::isfinite(how.distance));
    Representatives nearer = representatives_within(mesh.vertices, how.distance);
    for (std::uint32_t& r : representative) r = nearer.of[r];
    mesh.vertices = std::move(nearer.vertices);
  }
  for (Triangle& triangle : mesh.triangles) {
    for (std::uint32_t& v : triangle) v = representative[v];
  }
  return mesh;
}

}  // namespace raycone
