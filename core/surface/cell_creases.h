// Sharp edges of a mesh, and which of them come into which cells of a surface.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/surface/cell_triangles.h"
#include "core/surface/planes_point.h"

namespace raycone {

// Creases are sharp where the cosine between their triangles is at most this: from 15 degrees on.
inline constexpr double kSharpCosine = 0.9659258262890683;

// A crease is an edge that is not of two triangles, or whose triangles are at 0.1 degrees or more. It is sharp if they
// are at 15 degrees or more, or not two. Thread-safe.
class CellCreases {
 public:
  CellCreases() = default;  // none
  // Both as long as this. Precondition: `mesh` is welded.
  CellCreases(const TriangleMesh& mesh, const CellTriangles& triangles);

  // A side of a triangle, and its box.
  struct Crease {
    Vec3 from, to, lower, upper;
    bool is_sharp;
  };

  // Sets `found` to each crease with a point in the closed cell, and some more, in the order of triangles.
  void find(std::uint32_t cell, std::vector<Crease>& found) const;

 private:
  static constexpr unsigned kSharpBit = 4;

  const TriangleMesh* mesh_ = nullptr;
  const CellTriangles* triangles_ = nullptr;
  std::vector<std::uint8_t> sides_;  // of each triangle: bits for sides that are creases no lower triangle has
};

// The creases of one cell after the other, looked up when they are first asked for.
class CreasesHere {
 public:
  // `creases` must outlive this.
  explicit CreasesHere(const CellCreases& creases) : creases_(creases) {}

  void enter(std::uint32_t cell) {
    cell_ = cell;
    known_ = false;
  }

  // Whether a crease meets a triangle of the cell within a distance of `p`, which is more than what coordinates round.
  [[nodiscard]] bool has_hit_near(const std::array<Vec3, 3>& corners, const Vec3& p, double distance);

  // The point of a sharp crease on a triangle of the cell that is farthest from the line through two points of that
  // triangle.
  [[nodiscard]] std::optional<Vec3> farthest_hit(const std::array<Vec3, 3>& corners, const Vec3& p, const Vec3& q);

  // The point of a crease in a tetrahedron of the cell that is nearest to another one; of ends of creases within the
  // tetrahedron, with barycentric coordinates above `margin`. Both are relative to the first corner. Off by rounding.
  [[nodiscard]] std::optional<Vec3> nearest_within(const BarycentricCoordinates& within, const Vec3& near);
  [[nodiscard]] std::optional<Vec3> nearest_end_within(const BarycentricCoordinates& within, const Vec3& near,
                                                       double margin);

  // The point where creases end in a box: none, one, or many. A point nearer than `off` to the border counts as many.
  struct Ends {
    std::optional<Vec3> one;
    bool many = false;
  };
  [[nodiscard]] Ends ends_within(const Vec3& lower, const Vec3& upper, double off);

 private:
  using Crease = CellCreases::Crease;
  [[nodiscard]] const std::vector<Crease>& all() {
    if (!known_) creases_.find(cell_, found_);
    known_ = true;
    return found_;
  }

  const CellCreases& creases_;
  std::uint32_t cell_ = 0;
  bool known_ = false;
  std::vector<Crease> found_;
};

}  // namespace raycone
