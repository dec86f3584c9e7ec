// What triangles do to single rays along +x, by a grid over the triangles' projections along the ray.
#pragma once

#include <emmintrin.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/exact/scale.h"

namespace raycone {

// Each cell of the grid lists the triangles that a ray through it may cross or tie with; crowded cells hold a grid of
// their own. For each triangle of the list, single precision with an error bound decides all but a few rays in a
// thousand; the rest are left to exact predicates. No ray's triangle is missed: docs/method.md, "Points".
class ProjectedGrid {
 public:
  explicit ProjectedGrid(const TriangleMesh& mesh);

  // The sum of the signs of those crossings of the ray {q + t x, t >= 0} that are certain. Calls doubtful(i) once for
  // each other triangle i that the ray may cross, and for each whose closed box it meets and that has an edge with D =
  // 0 or holds q. Thread-safe.
  template <class Doubtful>
  [[nodiscard]] int crossings(const Vec3& q, const Doubtful& doubtful) const;

  // Calls visit(i) once for each triangle i that the ray {q + t x, t >= 0} may cross or that may hold q. Thread-safe.
  template <class Visit>
  void for_each_candidate(const Vec3& q, const Visit& visit) const;

  // Where a ray lies along a Z-curve through the projection, in [0, kMortonCodes): rays of neighbouring codes share
  // triangles.
  static constexpr std::size_t kMortonCodes = std::size_t{1} << 16;
  [[nodiscard]] std::uint16_t morton_code(const Vec3& q) const;

 private:
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
  static constexpr unsigned kEdges = 0b0111, kAhead = 0b1000;
  // Bit i: lane i is certainly positive, negative.
  struct Signs {
    unsigned positive, negative;
  };
  struct Entry {
    float upper_x;           // of the triangle, rounded up: rays from farther along miss it
    std::uint32_t triangle;  // its index in triangles_
  };
  // Its entries by falling upper_x, or the grid within it.
  struct Cell {
    std::uint64_t first_entry = 0;
    std::uint32_t entries = 0;
    std::uint32_t grid = 0;  // 0: none
  };
  struct Grid {
    double lower_y = 0, lower_z = 0;
    double columns_per_unit = 1, rows_per_unit = 1;
    std::uint32_t columns = 1, rows = 1;  // along y, along z
    std::uint64_t first_cell = 0;

    [[nodiscard]] std::uint32_t column(double y) const { return index((y - lower_y) * columns_per_unit, columns); }
    [[nodiscard]] std::uint32_t row(double z) const { return index((z - lower_z) * rows_per_unit, rows); }
    static std::uint32_t index(double offset, std::uint32_t count) {
      return offset > 0.0 ? std::min(static_cast<std::uint32_t>(std::min(offset, 0x1p31)), count - 1) : 0;
    }
  };
  class Builder;

  [[nodiscard]] Local local(const Vec3& p) const {
    return {unit_(p.x - centre_.x), unit_(p.y - centre_.y), unit_(p.z - centre_.z)};
  }
  [[nodiscard]] std::vector<std::uint32_t> in_morton_order(const TriangleMesh& mesh) const;
  [[nodiscard]] Filter filter_of(const Vec3& a, const Vec3& b, const Vec3& c) const;
  [[nodiscard]] const Cell& cell_at(double y, double z) const;
  // Whether the ray may meet the mesh's box.
  [[nodiscard]] bool may_meet_box(const Local& p) const {
    return p.y >= lower_.y && p.y <= upper_.y && p.z >= lower_.z && p.z <= upper_.z && p.x <= upper_.x;
  }

  Vec3 centre_;
  PowerOfTwo unit_;
  Local lower_, upper_;
  double codes_per_y_ = 0, codes_per_z_ = 0;
  std::vector<Grid> grids_;
  std::vector<Cell> cells_;
  std::vector<Entry> entries_;
  // The mesh's triangles along the Z-curve, so that neighbours lie together in memory, and their filters.
  std::vector<std::uint32_t> triangles_;
  std::vector<Filter> filters_;
};

inline const ProjectedGrid::Cell& ProjectedGrid::cell_at(double y, double z) const {
  const Grid* grid = &grids_.front();
  for (;;) {
    const Cell& cell = cells_[grid->first_cell + std::uint64_t{grid->row(z)} * grid->columns + grid->column(y)];
    if (cell.grid == 0) return cell;
    grid = &grids_[cell.grid];
  }
}

template <class Visit>
void ProjectedGrid::for_each_candidate(const Vec3& q, const Visit& visit) const {
  const Local p = local(q);
  if (!may_meet_box(p)) return;
  const auto x = static_cast<float>(std::max(p.x, -2.0));
  const Cell& cell = cell_at(p.y, p.z);
  for (const Entry& entry : std::span(entries_.data() + cell.first_entry, cell.entries)) {
    if (entry.upper_x < x) break;
    visit(triangles_[entry.triangle]);
  }
}

template <class Doubtful>
int ProjectedGrid::crossings(const Vec3& q, const Doubtful& doubtful) const {
  const Local p = local(q);
  if (!may_meet_box(p)) return 0;
  const auto x = static_cast<float>(std::max(p.x, -2.0));
  const __m128 xs = _mm_set_ps(x, 0, 0, 0);
  const __m128 ys = _mm_set1_ps(static_cast<float>(p.y)), zs = _mm_set1_ps(static_cast<float>(p.z));
  const auto signs = [&](const Filter& f) -> Signs {
    const __m128 plane = _mm_add_ps(_mm_mul_ps(_mm_load_ps(f.y), ys), _mm_mul_ps(_mm_load_ps(f.z), zs));
    const __m128 value = _mm_sub_ps(_mm_add_ps(plane, _mm_load_ps(f.one)), xs);
    const __m128 error = _mm_load_ps(f.error);
    return {static_cast<unsigned>(_mm_movemask_ps(_mm_cmpgt_ps(value, error))),
            static_cast<unsigned>(_mm_movemask_ps(_mm_cmplt_ps(value, _mm_sub_ps(_mm_setzero_ps(), error))))};
  };
  const Cell& cell = cell_at(p.y, p.z);
  int sum = 0;
  for (const Entry& entry : std::span(entries_.data() + cell.first_entry, cell.entries)) {
    if (entry.upper_x < x) break;
    const auto [positive, negative] = signs(filters_[entry.triangle]);
    // Without branches on the outcome, which no processor can foresee.
    const int left = (positive & kEdges) == kEdges, right = (negative & kEdges) == kEdges;
    const unsigned needed = kEdges | (left + right != 0 ? kAhead : 0);
    if (((positive | negative) & needed) != needed) {
      doubtful(triangles_[entry.triangle]);
    } else {
      sum += (positive & kAhead) != 0 ? left - right : 0;
    }
  }
  return sum;
}

}  // namespace raycone
