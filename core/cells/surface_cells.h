// The cells of a lattice that a surface between its nodes passes through.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/cells/kuhn.h"
#include "core/cells/node_set.h"

namespace raycone {

// A cell is known by its lowest node.
struct SurfaceCell {
  std::array<std::int64_t, 3> node;  // from 0
  std::uint8_t inside;               // a bit per corner; neither none nor all
  std::uint32_t first_edge;          // the number of its first mixed edge

  [[nodiscard]] bool is_inside(unsigned corner) const { return (inside >> corner & 1U) != 0; }
  // How many of eight bits are set: by default, compilers do not use the processor's instruction for it.
  static constexpr std::array<std::uint8_t, 256> kBits = [] {
    std::array<std::uint8_t, 256> bits{};
    for (unsigned n = 0; n < bits.size(); ++n) bits[n] = static_cast<std::uint8_t>(std::popcount(n));
    return bits;
  }();

  // A bit for each direction in which the edge from the lowest node has ends of both kinds.
  [[nodiscard]] unsigned mixed_directions() const { return (is_inside(0) ? ~unsigned{inside} : inside) & 0xFEU; }
  [[nodiscard]] bool has_edge(unsigned direction) const { return (mixed_directions() >> direction & 1U) != 0; }
  // The number of that edge. Precondition: has_edge(direction).
  [[nodiscard]] std::uint32_t edge(unsigned direction) const {
    return first_edge + kBits[mixed_directions() & ((1U << direction) - 1U)];
  }
};

// An edge with one end inside and one outside, and its number: below SurfaceCells::edges().
struct MixedEdge {
  Vec3 inside, outside;
  std::uint32_t number;

  [[nodiscard]] Vec3 point(double at) const { return inside + at * (outside - inside); }
};

// How many cells are mixed: have nodes of both kinds. SurfaceCells would hold these. Takes no memory, and little time.
// Precondition: !nodes.reaches_border().
[[nodiscard]] std::uint64_t mixed_cells(const NodeSet& nodes);

// Calls visit(node) for the lowest node of each mixed cell, in the order of their numbers. Precondition:
// !nodes.reaches_border().
void for_each_mixed_cell(const NodeSet& nodes, const std::function<void(const NodeSet::Node&)>& visit);

// All mixed cells, in the order of their nodes, and the mixed edges of the Kuhn subdivision: those of one cell after
// the other, by direction. A mixed edge, face or tetrahedron has its lowest node in a mixed cell.
class SurfaceCells {
 public:
  // Precondition: !nodes.reaches_border(). Throws std::length_error for more than 2147483632 edges.
  explicit SurfaceCells(const NodeSet& nodes);

  [[nodiscard]] const std::vector<SurfaceCell>& cells() const { return cells_; }
  [[nodiscard]] std::uint32_t edges() const { return edges_; }
  [[nodiscard]] const Lattice& lattice() const { return lattice_; }

  [[nodiscard]] Vec3 position(const std::array<std::int64_t, 3>& node) const;
  [[nodiscard]] Vec3 corner(const SurfaceCell& cell, unsigned number) const { return position(node_at(cell, number)); }
  [[nodiscard]] static std::array<std::int64_t, 3> node_at(const SurfaceCell& cell, unsigned corner) {
    return {cell.node[0] + (corner & 1U), cell.node[1] + (corner >> 1U & 1U), cell.node[2] + (corner >> 2U & 1U)};
  }

  // Calls visit(edge) for each mixed edge from the lowest node of a cell, by direction.
  template <class Visit>
  void for_each_edge(const SurfaceCell& cell, const Visit& visit) const {
    const Vec3 low = corner(cell, 0);
    for (unsigned direction = 1; direction < kuhn::kCorners; ++direction) {
      if (!cell.has_edge(direction)) continue;
      const Vec3 high = corner(cell, direction);
      visit(cell.is_inside(0) ? MixedEdge{low, high, cell.edge(direction)}
                              : MixedEdge{high, low, cell.edge(direction)});
    }
  }

  // The place of the cell whose lowest node is a corner of another one. Precondition: there is such a cell.
  [[nodiscard]] std::uint32_t cell_at(std::uint32_t cell, unsigned corner) const {
    const unsigned row = corner >> 1U, step = corner & 1U;
    if (row == 0) return cell + step;
    const std::uint32_t first = ahead_[cell][row - 1];
    return cells_[first].node[0] < cells_[cell].node[0] + step ? first + 1 : first;
  }

  // The cells of row (j, k) are those from row_begin(j, k) to row_end(j, k), by increasing x.
  [[nodiscard]] std::uint32_t row_begin(std::int64_t j, std::int64_t k) const { return rows_[row_number(j, k)]; }
  [[nodiscard]] std::uint32_t row_end(std::int64_t j, std::int64_t k) const { return rows_[row_number(j, k) + 1]; }
  [[nodiscard]] std::uint32_t first_from(std::uint32_t begin, std::uint32_t end, std::int64_t x) const;

  // Calls visit(place) for each cell that is no farther from a point along any axis than `part` of a voxel.
  template <class Visit>
  void for_each_near(const Vec3& p, double part, const Visit& visit) const {
    std::array<std::int64_t, 3> low, high;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const double at = lattice_.index_at(axis, p[axis]);
      low[a] = std::max<std::int64_t>(lattice_.cell_of(axis, at - part), 0);
      high[a] = std::min(lattice_.cell_of(axis, at + part), lattice_.counts[a] - 1);
    }
    for (std::int64_t k = low[2]; k <= high[2]; ++k) {
      for (std::int64_t j = low[1]; j <= high[1]; ++j) {
        const std::uint32_t end = row_end(j, k);
        for (std::uint32_t n = first_from(row_begin(j, k), end, low[0]); n < end && cells_[n].node[0] <= high[0]; ++n)
          visit(n);
      }
    }
  }

 private:
  [[nodiscard]] std::size_t row_number(std::int64_t j, std::int64_t k) const {
    return static_cast<std::size_t>(k * lattice_.counts[1] + j);
  }
  struct Layer;
  [[nodiscard]] static Layer layer_of(const NodeSet& nodes, std::int64_t k);
  void find_ahead(std::int64_t j, std::int64_t k);

  Lattice lattice_;
  std::vector<SurfaceCell> cells_;
  // Of each cell, in the rows (j + 1, k), (j, k + 1) and (j + 1, k + 1) of its own (j, k): the first cell whose x is
  // not below its own.
  std::vector<std::array<std::uint32_t, 3>> ahead_;
  std::vector<std::uint32_t> rows_;
  std::uint32_t edges_ = 0;
};

}  // namespace raycone
