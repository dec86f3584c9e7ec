#include "core/mesh/mesh_statistics.h"

#include <algorithm>

#include "core/exact/long_vec3.h"
#include "core/exact/predicates.h"
#include "core/machine/floating_point.h"
#include "core/mesh/components.h"
#include "core/mesh/edge_uses.h"

namespace raycone {
namespace {

void count_edges(const TriangleMesh& mesh, MeshStatistics& statistics) {
  for_each_edge(mesh, [&](const EdgeUse& use) {
    statistics.exterior_edges += use.is_exterior();
    statistics.nonmanifold_edges += use.is_nonmanifold();
    statistics.inconsistent_edges += use.is_inconsistent();
  });
}

std::uint64_t count_duplicates(const TriangleMesh& mesh) {
  std::vector<Triangle> sorted = mesh.triangles;
  for (Triangle& t : sorted) std::sort(t.begin(), t.end());
  std::sort(sorted.begin(), sorted.end());
  const auto last = std::unique(sorted.begin(), sorted.end());
  return static_cast<std::uint64_t>(sorted.end() - last);
}

std::uint64_t count_degenerate(const TriangleMesh& mesh) {
  const DefaultFloatingPoint guard;
  return static_cast<std::uint64_t>(std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
    return collinear(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
  }));
}

// Sum of the signed volumes of tetrahedra from the middle of the box, which keeps a distant mesh from cancelling.
double signed_volume(const TriangleMesh& mesh) {
  const Vec3 centre = middle(bounding_box(mesh));
  const auto from_centre = [&](std::uint32_t v) { return long_difference(mesh.vertices[v], centre); };
  long double sum = 0;
  for (const Triangle& t : mesh.triangles) sum += dot(from_centre(t[0]), cross(from_centre(t[1]), from_centre(t[2])));
  return static_cast<double>(sum / 6) + 0.0;  // never -0, which a small volume may round to
}

double surface_area(const TriangleMesh& mesh) {
  long double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    sum += norm(long_normal(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]));
  }
  return static_cast<double>(sum / 2);
}

}  // namespace

MeshStatistics mesh_statistics(const TriangleMesh& welded) {
  MeshStatistics statistics;
  count_edges(welded, statistics);
  statistics.degenerate_faces = count_degenerate(welded);
  statistics.duplicate_faces = count_duplicates(welded);
  statistics.components = components_of(welded).count;
  statistics.surface_area = surface_area(welded);
  if (statistics.closed()) statistics.signed_volume = signed_volume(welded);
  return statistics;
}

}  // namespace raycone
