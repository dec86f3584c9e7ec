// Some cells of a lattice, and which boxes meet them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/data/lattice.h"
#include "core/data/triangle_mesh.h"
#include "core/surface/node_set.h"

namespace raycone {

// Boxes have the cells that they meet, up to rounding: two that meet have one in common, for rounding is monotone. What
// is outside of the lattice has the cells at its border.
class CellSet {
 public:
  explicit CellSet(const Lattice& lattice) : cells_(lattice) {
    for (int axis = 0; axis < 3; ++axis) per_length_[axis] = 1.0 / lattice.spacing[axis];
  }

  void insert(const Box& box) {
    for_each_cell(box, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
      cells_.insert(i, j, k);
      return true;
    });
  }
  [[nodiscard]] bool meets(const Box& box) const {
    bool found = false;
    for_each_cell(box, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
      found = cells_.holds(i, j, k);
      return !found;
    });
    return found;
  }

 private:
  [[nodiscard]] std::int64_t cell_at(const Vec3& p, int axis) const {
    const Lattice& lattice = cells_.lattice();
    const auto a = static_cast<std::size_t>(axis);
    const double index = (p[axis] - lattice.origin[axis]) * per_length_[axis];
    const auto first = static_cast<double>(lattice.index_min[a]), last = static_cast<double>(lattice.counts[a] - 1);
    return static_cast<std::int64_t>(std::clamp(index - first, 0.0, last));
  }
  // As long as visit(i, j, k) returns true.
  template <class Visit>
  void for_each_cell(const Box& box, const Visit& visit) const {
    const std::int64_t first_i = cell_at(box.lower, 0), last_i = cell_at(box.upper, 0);
    const std::int64_t first_j = cell_at(box.lower, 1), last_j = cell_at(box.upper, 1);
    const std::int64_t last_k = cell_at(box.upper, 2);
    for (std::int64_t k = cell_at(box.lower, 2); k <= last_k; ++k) {
      for (std::int64_t j = first_j; j <= last_j; ++j) {
        for (std::int64_t i = first_i; i <= last_i; ++i) {
          if (!visit(i, j, k)) return;
        }
      }
    }
  }

  NodeSet cells_;  // by their lowest corners
  Vec3 per_length_;
};

}  // namespace raycone
