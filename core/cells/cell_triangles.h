// Which triangles come into which cells of a surface.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/cells/surface_cells.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

class CellTriangles {
 public:
  CellTriangles() = default;  // of no cells
  // `mesh` and `cells` are needed only here.
  CellTriangles(const TriangleMesh& mesh, const SurfaceCells& cells);

  // Each triangle that has a point in the closed cell, and some more; in increasing order.
  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t cell) const {
    return std::span(triangles_).subspan(begin_[cell], begin_[cell + 1] - begin_[cell]);
  }

 private:
  std::vector<std::uint64_t> begin_;
  std::vector<std::uint32_t> triangles_;
};

}  // namespace raycone
