#include "core/mesh/used_part.h"

#include <cstddef>
#include <cstdint>
#include <utility>

namespace raycone {

TriangleMesh used_part(const std::vector<Vec3>& vertices, std::vector<Triangle> triangles) {
  constexpr std::uint32_t kUnused = 0xFFFFFFFF;
  std::vector<std::uint32_t> number(vertices.size(), kUnused);
  std::uint32_t count = 0;
  for (Triangle& t : triangles) {
    for (std::uint32_t& corner : t) {
      if (number[corner] == kUnused) number[corner] = count++;
      corner = number[corner];
    }
  }
  TriangleMesh used{std::vector<Vec3>(count), std::move(triangles)};
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (number[v] != kUnused) used.vertices[number[v]] = vertices[v];
  }
  return used;
}

}  // namespace raycone
