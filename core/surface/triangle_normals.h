// Normals of a mesh's triangles, of which neighbouring places often need the same.
#pragma once

#include <array>
#include <cstdint>

#include "core/data/triangle_mesh.h"
#include "core/surface/edge_crossing.h"

namespace raycone {

// Remembers the last ones. One thread's own.
class TriangleNormals {
 public:
  // The mesh must stay.
  explicit TriangleNormals(const TriangleMesh& mesh) : mesh_(mesh) {}

  // What unit_normal() says of the triangle.
  [[nodiscard]] const Vec3& of(std::uint32_t triangle) {
    Known& known = known_[triangle % known_.size()];
    if (known.triangle != triangle) {
      const Triangle& t = mesh_.triangles[triangle];
      known = {triangle, unit_normal(mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]])};
    }
    return known.normal;
  }

 private:
  struct Known {
    std::uint32_t triangle = 0xFFFFFFFF;
    Vec3 normal;
  };
  const TriangleMesh& mesh_;
  std::array<Known, 64> known_;
};

}  // namespace raycone
