// What triangles do to single rays along +x, by a grid over the triangles' projections along the ray.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/crossings/crossings.h"
#include "core/data/triangle_mesh.h"
#include "core/exact/scale.h"

namespace raycone {

// Each cell of the grid lists the triangles that a ray through it may cross or tie with; crowded cells hold a grid of
// their own. For each triangle of the list, single precision with an error bound decides all but a few rays in a
// thousand; the rest are left to exact predicates. No ray's triangle is missed: docs/method.md, "Points".
class ProjectedGrid {
 public:
  // Precondition: at least one triangle.
  explicit ProjectedGrid(const TriangleMesh& mesh);

  // Sets n[i] to the sum of the signs of those crossings of the ray {queries[i] + t x, t >= 0} that are certain.
  // Appends each other triangle once that the ray may cross, where single precision cannot decide, and each whose
  // closed box it meets and that has an edge with D = 0 or holds the query. Precondition: less than 2^32 queries.
  // Thread-safe.
  void crossings(std::span<const Vec3> queries, std::span<std::int64_t> n, std::vector<RayCandidate>& doubtful) const;

  // Calls visit(i) once for each triangle i that the ray {q + t x, t >= 0} may cross or that may hold q. Thread-safe.
  template <class Visit>
  void for_each_candidate(const Vec3& q, const Visit& visit) const;

  // Rays of neighbouring codes, which lie along a Z-curve through the projection, share triangles.
  static constexpr std::size_t kMortonCodes = std::size_t{1} << 16;
  [[nodiscard]] std::uint16_t morton_code(const Vec3& q) const;
  struct Place {
    std::uint16_t morton_code;
    bool may_meet;  // false: crossings() finds nothing
  };
  // Sets places[i] for queries[i]. Thread-safe.
  void find_places(std::span<const Vec3> queries, std::span<Place> places) const;

 private:
  friend class ProjectedGridBuilder;

  // Coordinates about the centre of the mesh's box, in [-1, 1] for the mesh.
  struct Local {
    double x, y, z;
  };
  // The four numbers lane[i] = y[i] Y + z[i] Z + one[i] - (i == 3 ? X : 0) at (X, Y, Z), in single precision. Lanes 0
  // to 2: positive on the left side of the edges ab, bc, ca (the sign of D); lane 3: of a crossing, how far ahead of q.
  // Each is off by at most `error`.
  struct alignas(64) Filter {
    float y[4], z[4], one[4], error[4];
  };
  struct Entry {
    float upper_x;           // of the triangle, rounded up: rays from farther along miss it
    std::uint32_t triangle;  // its index in triangles_
  };
  // Its entries by falling upper_x, or the grid within it.
  struct Cell {
    static constexpr std::uint32_t kHoldsGrid = ~0U;

    std::uint64_t first = 0;    // of entries_, or the number of the grid
    std::uint32_t entries = 0;  // or kHoldsGrid
    float upper_x = 0;          // of all entries, also of those of a grid

    [[nodiscard]] bool holds_grid() const { return entries == kHoldsGrid; }
  };
  struct Grid {
    double lower_y = 0, lower_z = 0;
    double columns_per_unit = 1, rows_per_unit = 1;
    std::uint32_t columns = 1, rows = 1;  // along y, along z
    std::uint64_t first_cell = 0;

    [[nodiscard]] std::uint32_t column(double y) const { return index((y - lower_y) * columns_per_unit, columns); }
    [[nodiscard]] std::uint32_t row(double z) const { return index((z - lower_z) * rows_per_unit, rows); }
    [[nodiscard]] std::uint64_t cell(double y, double z) const {
      return first_cell + std::uint64_t{row(z)} * columns + column(y);
    }
    static std::uint32_t index(double offset, std::uint32_t count) {
      return offset > 0.0 ? std::min(static_cast<std::uint32_t>(std::min(offset, 0x1p31)), count - 1) : 0;
    }
  };
  class Coordinates;
  class Lookup;

  [[nodiscard]] Local local(const Vec3& p) const {
    return {unit_(p.x - centre_.x), unit_(p.y - centre_.y), unit_(p.z - centre_.z)};
  }
  // Along x, as entries are compared with it.
  static float to_float(double x) { return static_cast<float>(std::clamp(x, -2.0, 2.0)); }
  [[nodiscard]] Filter filter_of(const Vec3& a, const Vec3& b, const Vec3& c) const;
  [[nodiscard]] const Cell& cell_at(double y, double z) const {
    const Cell* cell = &cells_[grids_.front().cell(y, z)];
    while (cell->holds_grid()) cell = &cells_[grids_[cell->first].cell(y, z)];
    return *cell;
  }
  void set_farthest();
  // Whether the ray may meet the mesh's box.
  [[nodiscard]] bool may_meet_box(const Local& p) const {
    return p.y >= lower_.y && p.y <= upper_.y && p.z >= lower_.z && p.z <= upper_.z && p.x <= upper_.x;
  }

  [[nodiscard]] float farthest(std::uint16_t morton_code) const { return farthest_[morton_code >> 2 * coarser_]; }

  static constexpr double kMargin = 0x1p-16;  // of a cell, or of a square of codes: far more than rounding
  static constexpr std::uint32_t kCodesPerSide = 256;
  // Of the codes along y, in the lower half of v, and along z, in the upper one: they alternate in its bits.
  static std::uint16_t interleaved(std::uint32_t v) {
    v = (v | (v << 4)) & 0x0F0F0F0FU;
    v = (v | (v << 2)) & 0x33333333U;
    v = (v | (v << 1)) & 0x55555555U;
    return static_cast<std::uint16_t>(v | v >> 15);
  }

  Vec3 centre_;
  PowerOfTwo unit_;
  Local lower_, upper_;
  double codes_per_y_ = 0, codes_per_z_ = 0;
  std::vector<Grid> grids_;  // the first one covers all
  std::vector<Cell> cells_;
  std::unique_ptr<Entry[]> entries_;
  // Per square of 4^coarser_ Morton codes: upper_x of all entries of its rays. Small meshes have large squares.
  std::vector<float> farthest_;
  int coarser_ = 0;
  // The mesh's triangles along the Z-curve, so that neighbours lie together in memory, and their filters.
  std::vector<std::uint32_t> triangles_;
  std::unique_ptr<Filter[]> filters_;
};

template <class Visit>
void ProjectedGrid::for_each_candidate(const Vec3& q, const Visit& visit) const {
  const Local p = local(q);
  if (!may_meet_box(p)) return;
  const float x = to_float(p.x);
  const Cell& cell = cell_at(p.y, p.z);
  for (const Entry& entry : std::span(entries_.get() + cell.first, cell.entries)) {
    if (entry.upper_x < x) break;
    visit(triangles_[entry.triangle]);
  }
}

}  // namespace raycone
