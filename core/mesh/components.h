// The components of a mesh: sets of faces that are joined through vertices.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/mesh/vertex_links.h"

namespace raycone {

struct Components {
  std::uint32_t count = 0;
  std::vector<std::uint32_t> of_vertex;  // below `count` for vertices of faces; kUnused for others
  static constexpr std::uint32_t kUnused = 0xFFFFFFFF;
};

// Numbered by increasing lowest vertex.
[[nodiscard]] Components components_of(const TriangleMesh& mesh);
// The same, sooner. Precondition: all triangles are noted in `links`.
[[nodiscard]] Components components_of(const TriangleMesh& mesh, const VertexLinks& links);

}  // namespace raycone
