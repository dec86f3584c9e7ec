// The faces at each vertex of a mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

class VertexFaces {
 public:
  explicit VertexFaces(const TriangleMesh& mesh) : begin_(mesh.vertices.size() + 2, 0) {
    for (const Triangle& t : mesh.triangles) {
      for (const std::uint32_t corner : t) ++begin_[corner + std::size_t{2}];
    }
    for (std::size_t vertex = 2; vertex < begin_.size(); ++vertex) begin_[vertex] += begin_[vertex - 1];
    faces_.resize(begin_.back());
    // One place behind, where the next face goes; at last, where the next vertex begins.
    for (std::size_t face = 0; face < mesh.triangles.size(); ++face) {
      for (const std::uint32_t corner : mesh.triangles[face])
        faces_[begin_[corner + std::size_t{1}]++] = static_cast<std::uint32_t>(face);
    }
  }

  // In increasing order; a face with two equal corners there comes twice.
  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t vertex) const {
    return std::span(faces_).subspan(begin_[vertex], begin_[vertex + 1] - begin_[vertex]);
  }

 private:
  std::vector<std::size_t> begin_;
  std::vector<std::uint32_t> faces_;
};

}  // namespace raycone
