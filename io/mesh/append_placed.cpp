#include "io/mesh/append_placed.h"

#include <cstdint>
#include <utility>

#include "io/mesh/mesh_builder.h"
#include "io/mesh/mesh_error.h"

namespace raycone {

void append_placed(const TriangleMesh& added, const AffineMap& placement, const std::string& name, TriangleMesh& mesh) {
  const std::size_t first = mesh.vertices.size();
  if (added.vertices.size() > kMaxVertices - first) fail_too_many_vertices(name);
  for (const Vec3& vertex : added.vertices) mesh.vertices.push_back(transformed(placement, vertex));
  for (Triangle triangle : added.triangles) {
    for (std::uint32_t& corner : triangle) {
      if (!is_finite(mesh.vertices[first + corner])) {
        throw InputError(name + ": vertex " + std::to_string(corner) +
                         " is not finite once its transform is applied, expected finite coordinates");
      }
      corner += static_cast<std::uint32_t>(first);
    }
    if (placement.mirrored) std::swap(triangle[1], triangle[2]);
    mesh.triangles.push_back(triangle);
  }
}

}  // namespace raycone
