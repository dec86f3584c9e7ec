// Some cells of a lattice, and which boxes meet them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/data/lattice.h"
#include "core/data/vec3.h"
#include "core/surface/node_set.h"

namespace raycone {

// Boxes have the cells that they meet, up to rounding: two that meet have one in common, for rounding is monotone. What
// is outside of the lattice has the cells at its border.
class CellSet {
 public:
  using Cell = std::array<std::int32_t, 3>;
  // Those of a box: all from the first to the last along each axis.
  struct Range {
    Cell first, last;
  };

  explicit CellSet(const Lattice& lattice) : cells_(lattice) {
    for (int axis = 0; axis < 3; ++axis) per_length_[axis] = 1.0 / lattice.spacing[axis];
  }

  [[nodiscard]] Cell cell_of(const Vec3& p) const { return {cell_at(p, 0), cell_at(p, 1), cell_at(p, 2)}; }

  // Of the box of a triangle with corners in these cells.
  [[nodiscard]] static Range range_of(const Cell& a, const Cell& b, const Cell& c) {
    Range range;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      range.first[axis] = std::min({a[axis], b[axis], c[axis]});
      range.last[axis] = std::max({a[axis], b[axis], c[axis]});
    }
    return range;
  }

  void insert(const Range& range) {
    for_each_cell(range, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
      cells_.insert(i, j, k);
      return true;
    });
  }
  [[nodiscard]] bool meets(const Range& range) const {
    bool found = false;
    for_each_cell(range, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
      found = cells_.holds(i, j, k);
      return !found;
    });
    return found;
  }

 private:
  [[nodiscard]] std::int32_t cell_at(const Vec3& p, int axis) const {
    const Lattice& lattice = cells_.lattice();
    const auto a = static_cast<std::size_t>(axis);
    const double index = (p[axis] - lattice.origin[axis]) * per_length_[axis];
    const auto first = static_cast<double>(lattice.index_min[a]);
    const auto last = static_cast<double>(std::min<std::int64_t>(lattice.counts[a] - 1, INT32_MAX));
    return static_cast<std::int32_t>(std::clamp(index - first, 0.0, last));
  }
  // As long as visit(i, j, k) returns true.
  template <class Visit>
  static void for_each_cell(const Range& range, const Visit& visit) {
    for (std::int64_t k = range.first[2]; k <= range.last[2]; ++k) {
      for (std::int64_t j = range.first[1]; j <= range.last[1]; ++j) {
        for (std::int64_t i = range.first[0]; i <= range.last[0]; ++i) {
          if (!visit(i, j, k)) return;
        }
      }
    }
  }

  NodeSet cells_;  // by their lowest corners
  Vec3 per_length_;
};

}  // namespace raycone
