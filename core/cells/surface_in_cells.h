// What is known of a surface before it has faces: in the cells of a lattice, one by one.
#pragma once

#include <span>

#include "core/cells/cell_creases.h"
#include "core/cells/edge_points.h"
#include "core/cells/surface_cells.h"

namespace raycone {

// Refers to cells, points and creases, which must outlive it. Points stay away by a margin from where they may not be.
struct SurfaceInCells {
  const SurfaceCells& cells;
  std::span<const EdgePoint> edge_points;
  const CellCreases& creases;
  double tolerance;  // plane_tolerance(), world units
  double margin;     // a fraction of an edge, or of barycentric coordinates of a face or a cell

  // The margin as a length, world units: along the shortest spacing, and along the longest.
  [[nodiscard]] double least_margin() const { return margin * cells.lattice().least_spacing(); }
  [[nodiscard]] double largest_margin() const { return margin * cells.lattice().largest_spacing(); }
};

}  // namespace raycone
