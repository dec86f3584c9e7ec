// A mesh cut into the meshes of its parts.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/machine/sorted_by_key.h"

namespace raycone {

class MeshSplit {
 public:
  // Face f belongs to the part part_of[f], which is below `parts`. Takes time in proportion to the mesh.
  MeshSplit(TriangleMesh mesh, std::span<const std::uint32_t> part_of, std::uint32_t parts);

  [[nodiscard]] std::uint32_t parts() const { return static_cast<std::uint32_t>(faces_.keys()); }
  [[nodiscard]] const TriangleMesh& whole() const { return mesh_; }
  [[nodiscard]] std::uint64_t faces(std::uint32_t part) const { return faces_[part].size(); }

  // The faces of a part in their order, with the vertices that they use in the order of their first use. Takes time in
  // proportion to the part. One call at a time.
  [[nodiscard]] TriangleMesh part(std::uint32_t part);

 private:
  static constexpr std::uint32_t kUnused = 0xFFFFFFFF;

  TriangleMesh mesh_;
  SortedByKey<std::uint32_t> faces_;   // by part
  std::vector<std::uint32_t> number_;  // of each vertex in the part at hand; kUnused in between
};

}  // namespace raycone
