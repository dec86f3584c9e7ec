// How a ProjectedGrid is built.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/crossings/projected_grid.h"
#include "core/data/interval.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// Farther out by more than the rounding to float.
inline float rounded_up(double x) { return static_cast<float>(x + std::abs(x) * 0x1p-22 + 0x1p-120); }

// Chooses the cells and fills them, block of cells by block, on all threads.
class ProjectedGridBuilder {
 public:
  // `result` has its box and its units.
  ProjectedGridBuilder(const TriangleMesh& mesh, ProjectedGrid& result) : mesh_(mesh), result_(result) {}
  void build();

 private:
  using Cell = ProjectedGrid::Cell;
  using Entry = ProjectedGrid::Entry;
  using Grid = ProjectedGrid::Grid;
  using Local = ProjectedGrid::Local;

  // Grids lie within one another at most this deep, and no cell is smaller than this: far above the rounding of local
  // coordinates, far below what meshes need.
  static constexpr int kMaxDepth = 4;
  static constexpr double kSmallestCell = 0x1p-30;
  static constexpr double kMargin = ProjectedGrid::kMargin;  // added to cells and triangles on all sides, in cells

  struct Rectangle {
    Interval y, z;
  };
  // What a triangle, projected, fills.
  struct Footprint {
    Rectangle box;
    double area;  // of its box, if an edge ties everywhere; without the lines of its edges
    float upper_x;
  };
  struct EdgeLine;
  // Sums over the boxes of triangles.
  struct Sizes {
    double triangles = 0, widths = 0, heights = 0, areas = 0;

    void add(const Footprint& footprint, const Rectangle& within);
    Sizes& operator+=(const Sizes& other);
  };
  // The cells of a grid from the first column and row to the last ones, these included.
  struct Cells {
    std::uint32_t first_column, last_column, first_row, last_row;
    [[nodiscard]] std::uint64_t columns() const { return std::uint64_t{last_column} - first_column + 1; }
    [[nodiscard]] std::uint64_t rows() const { return std::uint64_t{last_row} - first_row + 1; }
    [[nodiscard]] std::uint64_t size() const { return columns() * rows(); }
  };
  class CellFinder;
  // The lists of some cells, row by row: those of cell i are entries[begin[i]] up to entries[begin[i + 1] - 1].
  struct Lists {
    std::vector<std::uint64_t> begin;
    std::vector<Entry> entries;
    [[nodiscard]] std::span<const Entry> operator[](std::size_t i) const {
      return std::span(entries).subspan(begin[i], begin[i + 1] - begin[i]);
    }
  };
  // What a block of the first grid's cells adds to the result, counted from its own first grid, cell and entry.
  struct Part {
    std::vector<Grid> grids;
    std::vector<Cell> cells;  // of these grids
    std::vector<Entry> entries;
  };

  void set_triangles();
  [[nodiscard]] Footprint footprint(const Triangle& t) const;
  [[nodiscard]] std::array<EdgeLine, 3> edges(std::uint32_t triangle) const;
  [[nodiscard]] Sizes all_sizes(const Rectangle& box) const;
  [[nodiscard]] static Grid choose(const Rectangle& box, const Sizes& sizes, double entries_per_triangle);
  // Calls visit(column, row) for each of the cells that the triangle belongs to.
  template <class Visit>
  void visit_cells(const CellFinder& finder, const Cells& cells, std::uint32_t triangle, const Visit& visit) const;
  // `entries`, by falling upper_x, as the cells list them.
  [[nodiscard]] Lists lists_of(const Grid& grid, const Cells& cells, std::span<const Entry> entries) const;

  void fill_blocks();
  [[nodiscard]] Part fill(const Cells& block, std::span<const std::uint32_t> triangles);
  [[nodiscard]] Cell finished(const Rectangle& box, std::span<const Entry> entries, int depth, Part& part) const;
  void add_grid(const Grid& grid, std::span<const Entry> entries, int depth, Part& part) const;
  void join(const std::vector<Cells>& blocks, const std::vector<Part>& parts);

  const TriangleMesh& mesh_;
  ProjectedGrid& result_;
  // Of result_.triangles_. Large arrays are first touched by the threads that fill them.
  std::unique_ptr<Footprint[]> footprints_;
};

}  // namespace raycone
