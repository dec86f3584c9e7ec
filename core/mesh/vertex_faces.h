// The faces at each vertex of a mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/data/triangle_mesh.h"
#include "core/machine/sorted_by_key.h"

namespace raycone {

class VertexFaces {
 public:
  explicit VertexFaces(const TriangleMesh& mesh)
      : faces_(mesh.vertices.size(), [&](const auto& emit) {
          for (std::size_t face = 0; face < mesh.triangles.size(); ++face) {
            for (const std::uint32_t corner : mesh.triangles[face]) emit(corner, static_cast<std::uint32_t>(face));
          }
        }) {}

  // In increasing order; a face with two equal corners there comes twice.
  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t vertex) const { return faces_[vertex]; }

 private:
  SortedByKey<std::uint32_t> faces_;  // by vertex
};

}  // namespace raycone
