// Sharp edges of a mesh, and which of them come into which cells of a surface.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/cells/cell_triangles.h"
#include "core/cells/edge_points.h"
#include "core/cells/planes_point.h"
#include "core/cells/surface_cells.h"
#include "core/cells/surface_mesh.h"
#include "core/cells/triangle_normals.h"
#include "core/data/box.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// Creases are sharp where the cosine between their triangles is at most this: from 15 degrees on.
inline constexpr double kSharpCosine = 0.9659258262890683;

// Sharp edges of a mesh. A crease is an edge of two triangles at an angle of 0.1 degrees or more, or an edge that is
// not of two triangles; it is sharp at 15 degrees or more, or if it is not of two. A fine crease is at 1e-7 radians or
// more, but less than 0.1 degrees. Const functions are thread-safe.
class CellCreases {
 public:
  CellCreases() = default;  // none
  // The first three must outlive this. Precondition: `mesh` is welded.
  CellCreases(const TriangleMesh& mesh, const TriangleNormals& normals, const CellTriangles& triangles,
              const SurfaceCells& cells);

  // A side of a triangle, and its box.
  struct Crease {
    Vec3 from, to;
    Box box;
    bool is_sharp, is_fine;
    std::array<std::uint32_t, 2> triangles;  // that it is of; twice the same one where these are not two
  };

  // Sets `found` to all creases, fine ones too, with a point in the closed cell, and some more, in the order of
  // triangles.
  void find(std::uint32_t cell, std::vector<Crease>& found) const;

  // Whether a crease, or a fine one, may end in a cell, or no farther from it than `off` (world units) along each axis.
  // Of most cells: no.
  [[nodiscard]] bool may_end_near(std::uint32_t cell, double off) const {
    return !(off <= end_reach_) || near_ends_[cell] != 0;
  }
  // The unit normal of the triangle `source`. Zero for kHole, for triangles without area, and where there are no
  // creases.
  [[nodiscard]] Vec3 normal_of(std::int32_t source) const {
    return source == kHole || !normals_ ? Vec3{} : normals_->of(static_cast<std::uint32_t>(source));
  }
  // Which flat part of the mesh a triangle is of: a number that is the same for triangles that hang together by edges
  // that are no creases, not even fine ones.
  [[nodiscard]] std::uint32_t part_of(std::uint32_t triangle) const { return parts_[triangle]; }

 private:
  static constexpr unsigned kCreaseBit = 4, kSharpBit = 8;

  void find_ends(const SurfaceCells& cells);

  const TriangleMesh* mesh_ = nullptr;
  const TriangleNormals* normals_ = nullptr;
  const CellTriangles* triangles_ = nullptr;
  // Of each triangle: bits for sides that no lower triangle has and that are creases, fine ones or others; for those
  // that are no fine ones; and for those that are sharp.
  std::vector<std::uint16_t> sides_;
  std::vector<std::array<std::uint32_t, 3>> beyond_;  // the triangle on the other side of each of these
  std::vector<std::uint32_t> parts_;                  // of each triangle, the lowest one of its part
  double end_reach_ = -1.0;
  std::vector<std::uint8_t> near_ends_;  // of each cell, whether an end of a crease is as near as that
};

// Which creases of a cell count.
enum class CreaseKinds : std::uint8_t { kNotFine, kAll };

// The creases of one cell after the other, looked up when they are first asked for. Fine creases count only where that
// is said. Not thread-safe.
class CreasesHere {
 public:
  // `creases` must outlive this.
  explicit CreasesHere(const CellCreases& creases) : creases_(creases) {}

  void enter(std::uint32_t cell) {
    cell_ = cell;
    known_ = false;
  }

  [[nodiscard]] const CellCreases& all_creases() const { return creases_; }

  // Whether a crease meets a triangle within the cell no farther than `distance` from `p`. The distance must be more
  // than what coordinates round.
  [[nodiscard]] bool has_hit_near(const Corners3& corners, const Vec3& p, double distance,
                                  CreaseKinds kinds = CreaseKinds::kNotFine);

  // The point of a sharp crease on a triangle within the cell that is farthest from the line through p and q, two
  // points of the triangle.
  [[nodiscard]] std::optional<Vec3> farthest_hit(const Corners3& corners, const Vec3& p, const Vec3& q);

  // How the mesh leads from one of its triangles to another one, seen in a triangle within the cell, from flat part to
  // flat part: the points of the creases in between, and the triangle beyond each of them.
  struct Section {
    static constexpr std::size_t kMost = 3;
    struct Corner {
      Vec3 position;
      std::uint32_t beyond;
    };
    std::array<Corner, kMost> corners{};
    std::size_t size = 0;  // 0 where creases do not lead there, or not just one way, or by more than kMost points
  };
  // Fine creases count.
  [[nodiscard]] Section section(const Corners3& corners, std::uint32_t from, std::uint32_t to);

  // The point of a crease in a tetrahedron within the cell that is nearest to `near`; the same of ends of creases whose
  // barycentric coordinates are above `margin`. Points are relative to the tetrahedron's first corner, and off by
  // rounding.
  [[nodiscard]] std::optional<Vec3> nearest_within(const BarycentricCoordinates& within, const Vec3& near,
                                                   CreaseKinds kinds = CreaseKinds::kNotFine);
  [[nodiscard]] std::optional<Vec3> nearest_end_within(const BarycentricCoordinates& within, const Vec3& near,
                                                       double margin);

  // The point where creases end in a box: none, one, or many. An end nearer to the box's border than `off` (world
  // units) counts as many.
  struct Ends {
    std::optional<Vec3> one;
    bool many = false;
  };
  [[nodiscard]] Ends ends_within(const Vec3& lower, const Vec3& upper, double off,
                                 CreaseKinds kinds = CreaseKinds::kNotFine);

 private:
  using Crease = CellCreases::Crease;
  struct CreaseHit {
    Vec3 position;
    std::array<std::uint32_t, 2> triangles;
  };
  [[nodiscard]] const std::vector<Crease>& all() {
    if (!known_) creases_.find(cell_, found_);
    known_ = true;
    return found_;
  }

  const CellCreases& creases_;
  std::uint32_t cell_ = 0;
  bool known_ = false;
  std::vector<Crease> found_;
  std::vector<CreaseHit> hits_;  // where section() is looked for
};

}  // namespace raycone
