// Cells that a surface passes through in a few planes, as polygons in these.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cells/cell_creases.h"
#include "core/cells/edge_points.h"
#include "core/cells/surface_cells.h"
#include "core/cells/surface_in_cells.h"
#include "core/cells/surface_mesh.h"
#include "core/contour/face_points.h"

namespace raycone {

// Which cells have the corners of a cell as their lowest nodes; for one cell after the other.
class CornerCells {
 public:
  explicit CornerCells(const SurfaceCells& cells) : cells_(cells) {}

  void enter(std::uint32_t cell) {
    known_.fill(kUnknown);
    known_[0] = cell;
  }
  // Precondition: there is such a cell.
  [[nodiscard]] std::uint32_t of(unsigned corner) {
    if (known_[corner] == kUnknown) known_[corner] = cells_.cell_at(known_[0], corner);
    return known_[corner];
  }

 private:
  static constexpr std::uint32_t kUnknown = 0xFFFFFFFF;

  const SurfaceCells& cells_;
  std::array<std::uint32_t, kuhn::kCorners> known_{};
};

// Convex, but for rounding; fronts look from inside to outside.
struct PlanePolygon {
  static constexpr std::size_t kMostCorners = 26;

  std::int32_t source = kHole;
  std::array<std::uint32_t, kMostCorners> corners{};  // edge points, then face points, as vertices of contour() are
  std::size_t size = 0;

  void add(std::uint32_t corner) { corners[size++] = corner; }
};

// The edge point on the diagonal of a square between two cells.
struct DiagonalPoint {
  std::uint32_t edge;
  bool is_above;   // whether the cell is above the face, along the axis across it
  bool is_inline;  // in line with the points before and behind it; so for both cells
};

// Says where the surface in a cell is a few polygons: all its points there are in the planes of their triangles, and
// the planes meet in straight lines through the cell, or in one point of the mesh in it. The polygons share sides
// within the cell; their other sides are the surface's lines on the cell's faces.
class CellPolygons {
 public:
  static constexpr std::uint32_t kApex = 0xFFFFFFFF;  // the number of the point where planes meet in the cell

  // All that is given here, and what `surface` refers to, must outlive this.
  CellPolygons(const SurfaceInCells& surface, const FacePoints& face_points, CreasesHere& creases, CornerCells& corners)
      : cells_(surface.cells),
        edge_points_(surface.edge_points),
        face_points_(face_points),
        creases_(creases),
        corners_(corners),
        unit_(surface.least_margin()) {}

  // Whether the surface in a cell is such polygons. Precondition: `creases` and `corners` have entered the cell.
  [[nodiscard]] bool find(std::uint32_t cell);

  // These are about the last find(), where it returned true.
  [[nodiscard]] std::span<const PlanePolygon> polygons() const { return std::span(polygons_).first(count_); }
  [[nodiscard]] const Vec3& apex() const { return apex_; }
  [[nodiscard]] std::span<const DiagonalPoint> diagonals() const {
    return std::span(diagonals_).first(diagonal_count_);
  }
  // Whether the loop has face points, so that planes meet in the cell.
  [[nodiscard]] bool has_face_points() const { return face_count_ > 0; }
  // The face points of the cell that no polygon has.
  [[nodiscard]] const std::vector<std::uint32_t>& spare_points() const { return spare_points_; }

 private:
  static constexpr std::size_t kSquares = 6, kMostSteps = 12, kMostRuns = kMostSteps + 1;

  struct LoopCorner {
    std::uint32_t vertex;
    Vec3 position;
    const EdgePoint* point;  // of an edge; none of a face
    unsigned square;         // that the next side is on
    unsigned direction;      // of the edge
    const EdgePoint* piece;  // of the next side, where that is between two points of a face
  };
  // A part of the loop, between two points of faces.
  struct Run {
    const EdgePoint* plane = nullptr;
    std::array<std::uint8_t, PlanePolygon::kMostCorners> corners{};  // of the loop
    std::size_t size = 0;

    void add(std::size_t corner) { corners[size++] = static_cast<std::uint8_t>(corner); }
    [[nodiscard]] std::span<const std::uint8_t> on_loop() const { return std::span(corners).first(size); }
  };

  bool find_loop();
  [[nodiscard]] bool has_needles() const;
  [[nodiscard]] bool is_near_node(const Vec3& p) const;
  [[nodiscard]] bool has_corner_at_node(const Run& run) const;
  void find_runs();
  bool find_planes();
  bool find_ends();
  bool holds_diagonal();
  bool holds_face_points();
  bool cut_off_runs();
  bool cone_runs();
  [[nodiscard]] bool is_one_plane(const Run& a, const Run& b) const;
  PlanePolygon& add_polygon(const Run& run);
  void find_diagonals();
  [[nodiscard]] bool is_in_plane(const EdgePoint& plane, const Vec3& p) const;
  [[nodiscard]] std::size_t planes_through(const Vec3& p) const;

  const SurfaceCells& cells_;
  std::span<const EdgePoint> edge_points_;
  const FacePoints& face_points_;
  CreasesHere& creases_;
  CornerCells& corners_;
  double unit_;  // the margin that points are kept off what they may not reach, world units

  std::uint32_t cell_ = 0;
  std::array<LoopCorner, 2 * kMostSteps> loop_{};
  std::size_t loop_size_ = 0, face_count_ = 0;
  std::array<Run, kMostRuns> runs_{};
  std::size_t run_count_ = 0;
  std::array<const EdgePoint*, kMostRuns> planes_{};
  bool has_apex_ = false;
  Vec3 apex_;
  std::array<PlanePolygon, kMostRuns> polygons_{};
  std::size_t count_ = 0;
  std::array<DiagonalPoint, kSquares> diagonals_{};
  std::size_t diagonal_count_ = 0;
  std::vector<std::uint32_t> spare_points_;
};

// Of each cell: 1 where it is at a face with sections and the surface is polygons there, else 0. Uses the threads that
// ThreadLimit allows; the same for any number of them.
[[nodiscard]] std::vector<std::uint8_t> polygons_at_sections(const SurfaceInCells& surface,
                                                             const FacePoints& face_points);

// The corner at which to cut a polygon into triangles, so that the worst of them is as good as can be.
[[nodiscard]] std::size_t best_fan(std::span<const Vec3> polygon);

}  // namespace raycone
