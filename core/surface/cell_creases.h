// Sharp edges of a mesh, and which of them come into which cells of a surface.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/surface/cell_triangles.h"

namespace raycone {

// A crease is an edge that is not of two triangles, or whose triangles are at 0.1 degrees or more. It is sharp if they
// are at 15 degrees or more, or not two. Thread-safe.
class CellCreases {
 public:
  CellCreases() = default;  // none
  // Both as long as this. Precondition: `mesh` is welded.
  CellCreases(const TriangleMesh& mesh, const CellTriangles& triangles);

  enum class Which : std::uint8_t { kSharp, kAll };

  // Calls visit(a, b) for each crease with a point in the closed cell, and for some more, in the order of triangles.
  template <class Visit>
  void for_each(std::uint32_t cell, Which which, const Visit& visit) const {
    if (!triangles_) return;
    for (const std::uint32_t triangle : triangles_->of(cell)) {
      const Triangle& t = mesh_->triangles[triangle];
      for (unsigned side = 0; side < t.size(); ++side) {
        if ((sides_[triangle] >> (which == Which::kSharp ? side + kSharpBit : side) & 1U) == 0) continue;
        visit(mesh_->vertices[t[side]], mesh_->vertices[t[(side + 1) % t.size()]]);
      }
    }
  }

  // Whether a crease meets a triangle of the cell within a distance of `p`.
  [[nodiscard]] bool has_hit_near(std::uint32_t cell, const std::array<Vec3, 3>& corners, const Vec3& p,
                                  double distance) const;

  // The point of a sharp crease on a triangle of the cell that is farthest from the line through two points of that
  // triangle.
  [[nodiscard]] std::optional<Vec3> farthest_hit(std::uint32_t cell, const std::array<Vec3, 3>& corners, const Vec3& p,
                                                 const Vec3& q) const;

  // The point of a crease in a tetrahedron of the cell that is nearest to another one; of ends of creases within the
  // tetrahedron, with barycentric coordinates above `margin`. Both are relative to the first corner. Off by rounding.
  [[nodiscard]] std::optional<Vec3> nearest_within(std::uint32_t cell, const std::array<Vec3, 4>& corners,
                                                   const Vec3& near) const;
  [[nodiscard]] std::optional<Vec3> nearest_end_within(std::uint32_t cell, const std::array<Vec3, 4>& corners,
                                                       const Vec3& near, double margin) const;

 private:
  static constexpr unsigned kSharpBit = 4;

  template <class Visit>
  void for_each_hit(std::uint32_t cell, Which which, const std::array<Vec3, 3>& corners, const Visit& visit) const;

  const TriangleMesh* mesh_ = nullptr;
  const CellTriangles* triangles_ = nullptr;
  std::vector<std::uint8_t> sides_;  // of each triangle: bits for sides that are creases no lower triangle has
};

}  // namespace raycone
