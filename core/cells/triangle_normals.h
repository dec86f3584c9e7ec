// Normals of a mesh's triangles, of which the surface's cells and faces ask again and again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// What unit_normal() says of each triangle. Thread-safe.
class TriangleNormals {
 public:
  TriangleNormals() = default;  // of no triangles
  explicit TriangleNormals(const TriangleMesh& mesh);

  [[nodiscard]] std::size_t size() const { return normals_.size(); }
  [[nodiscard]] const Vec3& of(std::uint32_t triangle) const { return normals_[triangle]; }

 private:
  std::vector<Vec3> normals_;
};

}  // namespace raycone
