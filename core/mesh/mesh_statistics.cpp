#include "core/mesh/mesh_statistics.h"

#include <algorithm>
#include <array>
#include <cmath>

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
  using Wide = long double;  // for its exponents, too: no product of three coordinates leaves them
  const Vec3 centre = middle(bounding_box(mesh));
  const auto from_centre = [&](std::uint32_t v) {
    const Vec3& p = mesh.vertices[v];
    return std::array<Wide, 3>{Wide(p.x) - centre.x, Wide(p.y) - centre.y, Wide(p.z) - centre.z};
  };
  Wide sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const auto a = from_centre(t[0]), b = from_centre(t[1]), c = from_centre(t[2]);
    sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return static_cast<double>(sum / 6) + 0.0;  // never -0, which a small volume may round to
}

// Wide for the exponents of squares. Corners are moved to the first one before they are multiplied.
double surface_area(const TriangleMesh& mesh) {
  using Wide = long double;
  Wide sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &p = mesh.vertices[t[0]], &q = mesh.vertices[t[1]], &r = mesh.vertices[t[2]];
    const Wide ax = Wide(q.x) - p.x, ay = Wide(q.y) - p.y, az = Wide(q.z) - p.z;
    const Wide bx = Wide(r.x) - p.x, by = Wide(r.y) - p.y, bz = Wide(r.z) - p.z;
    const Wide x = ay * bz - az * by, y = az * bx - ax * bz, z = ax * by - ay * bx;
    sum += std::sqrt(x * x + y * y + z * z);
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
