// Candidate triangles of rays along +x, by a uniform grid over the triangles' projections along the ray.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/triangle_mesh.h"

namespace raycone {

class ProjectedGrid {
 public:
  // About as many cells as triangles, fewer where large triangles would fill too many. `mesh` has at least one
  // triangle.
  explicit ProjectedGrid(const TriangleMesh& mesh);

  // Replaces `candidates` by each triangle whose closed box meets the closed ray {origin + t x, t >= 0} once, in
  // increasing order, and possibly others. Thread-safe.
  void find_candidates(const Vec3& origin, std::vector<std::uint32_t>& candidates) const;

  // Number of the cell that a query falls into: queries of neighbouring numbers share candidates.
  [[nodiscard]] std::size_t cell_of(const Vec3& origin) const;

  // Triangles of a cell, averaged over the triangles' cells: what a query among the triangles costs.
  [[nodiscard]] double expected_candidates() const;

 private:
  // One axis of the grid: [lower, upper] in `cells` cells. Monotone, and clamped to the ends.
  struct Axis {
    double lower = 0.0;
    double cells_per_unit = 0.0;
    std::size_t cells = 1;
    [[nodiscard]] std::size_t cell(double x) const;
  };
  // The box of a triangle rounded outward, as far as a ray can miss it.
  struct FloatBox {
    float lower_y, upper_y, lower_z, upper_z, upper_x;
  };

  void choose_resolution(const TriangleMesh& mesh, const Box& box);
  void fill(const TriangleMesh& mesh);

  Axis y_, z_;
  Box box_;
  std::vector<std::size_t> begin_;  // per cell, into triangles_; and the end
  std::vector<std::uint32_t> triangles_;
  std::vector<FloatBox> boxes_;  // per entry of triangles_
};

}  // namespace raycone
