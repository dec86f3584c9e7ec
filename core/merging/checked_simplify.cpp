#include "core/merging/checked_simplify.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/cells/surface_mesh.h"
#include "core/certificate/certificate.h"
#include "core/certificate/component_signs.h"
#include "core/certificate/fault_places.h"
#include "core/merging/simplify.h"
#include "core/mesh/used_part.h"

namespace raycone {
namespace {

// The vertices of components that enclose no volume now, or face the other way than before: slivers that went flat.
std::vector<bool> turned_vertices(const TriangleMesh& mesh, const ComponentSigns& before) {
  const ComponentSigns signs = component_signs(mesh);
  std::vector<bool> turned(mesh.vertices.size(), false);
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) turned[v] = signs.of_vertex(v) != before.of_vertex(v);
  }
  return turned;
}

}  // namespace

bool checked_simplify(SurfaceMesh& surface, const NodeSet& inside, double most, int rounds) {
  const std::vector<Vec3>& vertices = surface.mesh.vertices;
  const ComponentSigns signs = component_signs(surface.mesh);
  std::vector<bool> kept(vertices.size(), false);
  for (int round = 0; round < rounds; ++round) {
    MergedFaces merged = simplify(surface, inside, kept, most);
    TriangleMesh compact = used_part(vertices, merged.triangles);
    NodeSet misplaced(inside.lattice());
    const SurfaceFaults faults = faults_of(compact, inside, &misplaced);
    std::vector<bool> touched = faulty_vertices(vertices.size(), merged.triangles, faults);
    if (faults.none()) {
      touched = turned_vertices({vertices, merged.triangles}, signs);
      if (std::ranges::find(touched, true) == touched.end()) {
        surface = {std::move(compact), std::move(merged.sources)};
        return true;
      }
    }
    touch_faces_beside(vertices, merged.triangles, misplaced, touched);
    const std::vector<bool> before = kept;
    for (std::size_t v = 0; v < kept.size(); ++v) kept[v] = kept[v] || touched[merged.into[v]];
    if (kept == before) return false;  // another round would be the same
  }
  return false;
}

}  // namespace raycone
