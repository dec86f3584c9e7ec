// Some cells of a lattice, and which boxes meet them.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/cells/node_set.h"
#include "core/data/lattice.h"
#include "core/data/vec3.h"

namespace raycone {

// Boxes have the cells that they meet, up to rounding. Two boxes that meet have a cell in common, for rounding is
// monotone. What is outside of the lattice has the cells at its border. Large boxes have larger cells, so that none has
// many: at level n, 2^n cells of the lattice along each axis.
class CellSet {
 public:
  using Cell = std::array<std::int32_t, 3>;
  // The cells of a box: all from the first to the last along each axis.
  struct Range {
    Cell first, last;
  };

  explicit CellSet(const Lattice& lattice) : lattice_(lattice), any_{NodeSet(lattice)} {
    for (int axis = 0; axis < 3; ++axis) per_length_[axis] = 1.0 / lattice.spacing[axis];
    Lattice larger = lattice;
    const auto most =
        static_cast<std::int32_t>(std::min<std::int64_t>(std::ranges::max(lattice.counts), INT32_MAX) - 1);
    for (std::size_t level = level_of({{0, 0, 0}, {most, 0, 0}}); level > 0; --level) {
      for (std::int64_t& count : larger.counts) count = (count + 1) / 2;
      own_.emplace_back(larger);
      any_.emplace_back(larger);
    }
  }

  [[nodiscard]] Cell cell_of(const Vec3& p) const { return {cell_at(p, 0), cell_at(p, 1), cell_at(p, 2)}; }

  // The cells of the box of a triangle with corners in these cells.
  [[nodiscard]] static Range range_of(const Cell& a, const Cell& b, const Cell& c) {
    Range range;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      range.first[axis] = std::min({a[axis], b[axis], c[axis]});
      range.last[axis] = std::max({a[axis], b[axis], c[axis]});
    }
    return range;
  }

  void insert(const Range& range) {
    std::size_t level = level_of(range);
    last_ = std::max(last_, level);
    if (level > 0) static_cast<void>(add(range, level, own_[level - 1]));
    // Where all cells were there, the larger ones that they are in are, too.
    while (level < any_.size() && add(range, level, any_[level])) ++level;
  }
  // Whether a range that was inserted has a cell in common with this one; or, where one of the two is large, perhaps is
  // only nearer than its size.
  [[nodiscard]] bool meets(const Range& range) const {
    std::size_t level = level_of(range);
    if (has(range, level, any_[level])) return true;
    for (++level; level <= last_; ++level) {
      if (has(range, level, own_[level - 1])) return true;
    }
    return false;
  }

 private:
  [[nodiscard]] std::int32_t cell_at(const Vec3& p, int axis) const {
    const auto a = static_cast<std::size_t>(axis);
    const double index = (p[axis] - lattice_.origin[axis]) * per_length_[axis];
    const auto first = static_cast<double>(lattice_.index_min[a]);
    const auto last = static_cast<double>(std::min<std::int64_t>(lattice_.counts[a] - 1, INT32_MAX));
    return static_cast<std::int32_t>(std::clamp(index - first, 0.0, last));
  }
  // The lowest one where a range has at most nine cells along each axis, wherever it is. Faces of a contour are all at
  // level 0, so that they are looked for there only.
  [[nodiscard]] static std::size_t level_of(const Range& range) {
    std::int32_t steps = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) steps = std::max(steps, range.last[axis] - range.first[axis]);
    const auto digits = static_cast<std::size_t>(std::bit_width(static_cast<std::uint32_t>(steps)));
    return digits > 3 ? digits - 3 : 0;
  }
  // As long as visit(i, j, k) returns true.
  template <class Visit>
  static void for_each_cell(const Range& range, std::size_t level, const Visit& visit) {
    for (std::int64_t k = range.first[2] >> level; k <= range.last[2] >> level; ++k) {
      for (std::int64_t j = range.first[1] >> level; j <= range.last[1] >> level; ++j) {
        for (std::int64_t i = range.first[0] >> level; i <= range.last[0] >> level; ++i) {
          if (!visit(i, j, k)) return;
        }
      }
    }
  }
  [[nodiscard]] static bool has(const Range& range, std::size_t level, const NodeSet& cells) {
    bool found = false;
    for_each_cell(range, level, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
      found = cells.holds(i, j, k);
      return !found;
    });
    return found;
  }
  // Whether one is new.
  [[nodiscard]] static bool add(const Range& range, std::size_t level, NodeSet& cells) {
    bool is_new = false;
    for_each_cell(range, level, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
      is_new = is_new || !cells.holds(i, j, k);
      cells.insert(i, j, k);
      return true;
    });
    return is_new;
  }

  Lattice lattice_;
  Vec3 per_length_;
  // By their lowest corners, of each level: the cells that a box has, from level 1 on; and those that a box has a cell
  // in, of that level or a lower one.
  std::vector<NodeSet> own_, any_;
  std::size_t last_ = 0;  // the largest level of a box
};

}  // namespace raycone
