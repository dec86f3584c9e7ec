// The cells of a lattice that a surface between its nodes passes through.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "core/surface/kuhn.h"
#include "core/surface/node_set.h"

namespace raycone {

// A cell is known by its lowest node.
struct SurfaceCell {
  std::array<std::int64_t, 3> node;  // from 0
  std::uint8_t inside;               // a bit per corner; neither none nor all
  std::uint32_t first_edge;

  [[nodiscard]] bool is_inside(unsigned corner) const { return (inside >> corner & 1U) != 0; }
  // How many of eight bits are set: by default, compilers do not use the processor's instruction for it.
  static constexpr std::array<std::uint8_t, 256> kBits = [] {
    std::array<std::uint8_t, 256> bits{};
    for (unsigned n = 0; n < bits.size(); ++n) bits[n] = static_cast<std::uint8_t>(std::popcount(n));
    return bits;
  }();

  // A bit for each direction in which the edge from the lowest node has ends of both kinds.
  [[nodiscard]] unsigned mixed_directions() const { return (is_inside(0) ? ~unsigned{inside} : inside) & 0xFEU; }
  [[nodiscard]] std::uint32_t edge(unsigned direction) const {
    return first_edge + kBits[mixed_directions() & ((1U << direction) - 1U)];
  }
};

// How many cells have nodes of both kinds: those that SurfaceCells would hold. Takes no memory, and little
// time. Precondition: !nodes.reaches_border().
[[nodiscard]] std::uint64_t mixed_cells(const NodeSet& nodes);

// All cells with nodes of both kinds, in the order of their nodes, and the mixed edges of the Kuhn subdivision: those
// of one cell after the other, by direction. An edge, a face or a tetrahedron with nodes of both kinds has its lowest
// node in such a cell.
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

  // The place of the cell whose lowest node is a corner of another one. Precondition: there is such a cell.
  [[nodiscard]] std::uint32_t cell_at(std::uint32_t cell, unsigned corner) const;

  // The cells of row (j, k) are those from row_begin(j, k) to row_end(j, k), by increasing x.
  [[nodiscard]] std::uint32_t row_begin(std::int64_t j, std::int64_t k) const { return rows_[row_number(j, k)]; }
  [[nodiscard]] std::uint32_t row_end(std::int64_t j, std::int64_t k) const { return rows_[row_number(j, k) + 1]; }
  [[nodiscard]] std::uint32_t first_from(std::uint32_t begin, std::uint32_t end, std::int64_t x) const;

 private:
  [[nodiscard]] std::size_t row_number(std::int64_t j, std::int64_t k) const {
    return static_cast<std::size_t>(k * lattice_.counts[1] + j);
  }
  struct Layer;
  [[nodiscard]] static Layer layer_of(const NodeSet& nodes, std::int64_t k);

  Lattice lattice_;
  std::vector<SurfaceCell> cells_;
  std::vector<std::uint32_t> rows_;
  std::uint32_t edges_ = 0;
};

}  // namespace raycone
