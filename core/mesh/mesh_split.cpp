#include "core/mesh/mesh_split.h"

#include <utility>

namespace raycone {

MeshSplit::MeshSplit(TriangleMesh mesh, std::span<const std::uint32_t> part_of, std::uint32_t parts)
    : mesh_(std::move(mesh)),
      faces_(parts,
             [&](const auto& emit) {
               for (std::size_t f = 0; f < part_of.size(); ++f) emit(part_of[f], static_cast<std::uint32_t>(f));
             }),
      number_(mesh_.vertices.size(), kUnused) {}

TriangleMesh MeshSplit::part(std::uint32_t part) {
  TriangleMesh result;
  std::vector<std::uint32_t> used;
  result.triangles.reserve(faces(part));
  for (const std::uint32_t face : faces_[part]) {
    Triangle triangle = mesh_.triangles[face];
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
