#include "core/mesh/mesh_split.h"

#include <numeric>
#include <utility>

namespace raycone {

MeshSplit::MeshSplit(TriangleMesh mesh, std::span<const std::uint32_t> part_of, std::uint32_t parts)
    : mesh_(std::move(mesh)),
      begins_(std::size_t{parts} + 1),
      faces_(part_of.size()),
      number_(mesh_.vertices.size(), kUnused) {
  for (const std::uint32_t part : part_of) ++begins_[part + 1];
  std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
  std::vector<std::size_t> next(begins_.begin(), begins_.end() - 1);
  for (std::size_t f = 0; f < part_of.size(); ++f) faces_[next[part_of[f]]++] = static_cast<std::uint32_t>(f);
}

TriangleMesh MeshSplit::part(std::uint32_t part) {
  TriangleMesh result;
  std::vector<std::uint32_t> used;
  result.triangles.reserve(faces(part));
  for (std::size_t n = begins_[part]; n < begins_[part + 1]; ++n) {
    Triangle triangle = mesh_.triangles[faces_[n]];
    for (std::uint32_t& vertex : triangle) {
      std::uint32_t& number = number_[vertex];
      if (number == kUnused) {
        number = static_cast<std::uint32_t>(used.size());
        used.push_back(vertex);
      }
      vertex = number;
    }
    result.triangles.push_back(triangle);
  }
  result.vertices.reserve(used.size());
  for (const std::uint32_t vertex : used) {
    result.vertices.push_back(mesh_.vertices[vertex]);
    number_[vertex] = kUnused;
  }
  return result;
}

}  // namespace raycone
