#include "core/cells/surface_cells.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <stdexcept>

#include "core/machine/first_touch.h"
#include "core/machine/threads.h"

namespace raycone {

namespace {

// Which cells of a row have nodes of both kinds: a bit for each of the 64 cells from 64 * `word` on.
std::uint64_t mixed_among(const std::array<const std::uint64_t*, 4>& rows, std::int64_t word, std::int64_t words) {
  std::uint64_t any = 0, all = ~std::uint64_t{0};
  for (const std::uint64_t* const row : rows) {
    const std::uint64_t here = row[word], next = here >> 1U | (word + 1 < words ? row[word + 1] << 63U : 0);
    any |= here | next;
    all &= here & next;
  }
  return any & ~all;
}

// By default, compilers do not use the processor's instruction for it; most words are 0.
std::uint64_t count_of_ones(std::uint64_t word) {
  return word == 0 ? 0 : static_cast<std::uint64_t>(std::popcount(word));
}

// The four rows of nodes that a row of cells lies between.
std::array<const std::uint64_t*, 4> rows_around(const NodeSet& nodes, std::int64_t j, std::int64_t k) {
  return {nodes.row(j, k), nodes.row(j + 1, k), nodes.row(j, k + 1), nodes.row(j + 1, k + 1)};
}

// Calls visit(cells, word, j, k) for the cells of each row (j, k) with nodes of both kinds, as mixed_among() tells.
template <class Visit>
void for_each_mixed_word(const NodeSet& nodes, const Visit& visit) {
  const std::int64_t words = nodes.words_per_row();
  for (std::int64_t k = 0; k + 1 < nodes.count(2); ++k) {
    for (std::int64_t j = 0; j + 1 < nodes.count(1); ++j) {
      const std::array rows = rows_around(nodes, j, k);
      for (std::int64_t word = 0; word < words; ++word) visit(mixed_among(rows, word, words), word, j, k);
    }
  }
}

}  // namespace

std::uint64_t mixed_cells(const NodeSet& nodes) {
  std::uint64_t count = 0;
  for_each_mixed_word(nodes, [&](std::uint64_t cells, auto...) { count += count_of_ones(cells); });
  return count;
}

void for_each_mixed_cell(const NodeSet& nodes, const std::function<void(const NodeSet::Node&)>& visit) {
  for_each_mixed_word(nodes, [&](std::uint64_t cells, std::int64_t word, std::int64_t j, std::int64_t k) {
    for (; cells != 0; cells &= cells - 1) visit({word * 64 + std::countr_zero(cells), j, k});
  });
}

// Places of cells and edges are the layer's own.
struct SurfaceCells::Layer {
  std::vector<SurfaceCell> cells;
  std::vector<std::uint32_t> rows;  // where each begins
  std::uint64_t edges = 0;
  std::uint32_t first_cell = 0, first_edge = 0;

  void add_row(const NodeSet& nodes, std::int64_t j, std::int64_t k);
};

void SurfaceCells::Layer::add_row(const NodeSet& nodes, std::int64_t j, std::int64_t k) {
  const std::array around = rows_around(nodes, j, k);
  const std::int64_t words = nodes.words_per_row();
  for (std::int64_t word = 0; word < words; ++word) {
    for (std::uint64_t left = mixed_among(around, word, words); left != 0; left &= left - 1) {
      const std::int64_t i = word * 64 + std::countr_zero(left);
      SurfaceCell cell{{i, j, k}, 0, static_cast<std::uint32_t>(edges)};
      for (unsigned corner = 0; corner < kuhn::kCorners; ++corner) {
        const auto [x, y, z] = node_at(cell, corner);
        if (x < nodes.count(0) && nodes.holds(x, y, z)) cell.inside |= static_cast<std::uint8_t>(1U << corner);
      }
      cells.push_back(cell);
      edges += SurfaceCell::kBits[cell.mixed_directions()];
    }
  }
}

SurfaceCells::Layer SurfaceCells::layer_of(const NodeSet& nodes, std::int64_t k) {
  Layer layer;
  for (std::int64_t j = 0; j < nodes.count(1); ++j) {
    layer.rows.push_back(static_cast<std::uint32_t>(layer.cells.size()));
    if (j + 1 < nodes.count(1) && k + 1 < nodes.count(2)) layer.add_row(nodes, j, k);
  }
  return layer;
}

SurfaceCells::SurfaceCells(const NodeSet& nodes) : lattice_(nodes.lattice()) {
  assert(!nodes.reaches_border());
  constexpr std::uint64_t kMostEdges = 0x7FFFFFF0;
  std::vector<Layer> layers(static_cast<std::size_t>(lattice_.counts[2]));
  const auto for_each_layer = [&](const auto& visit) { parallel_for_each(layers.size(), visit); };
  for_each_layer([&](std::size_t k) { layers[k] = layer_of(nodes, static_cast<std::int64_t>(k)); });
  std::uint64_t cells = 0, edges = 0;
  for (Layer& layer : layers) {
    layer.first_cell = static_cast<std::uint32_t>(cells);
    layer.first_edge = static_cast<std::uint32_t>(edges);
    cells += layer.cells.size();
    edges += layer.edges;
    if (edges > kMostEdges) throw std::length_error("raycone: a surface of more than 2147483632 lattice edges");
  }
  edges_ = static_cast<std::uint32_t>(edges);
  resize_on_all_threads(cells_, cells);
  const auto rows = static_cast<std::size_t>(lattice_.counts[1]);
  rows_.resize(rows * layers.size() + 1, static_cast<std::uint32_t>(cells));
  for_each_layer([&](std::size_t k) {
    Layer& layer = layers[k];
    for (std::size_t j = 0; j < rows; ++j) rows_[k * rows + j] = layer.first_cell + layer.rows[j];
    for (std::size_t n = 0; n < layer.cells.size(); ++n) {
      SurfaceCell& cell = cells_[layer.first_cell + n];
      cell = layer.cells[n];
      cell.first_edge += layer.first_edge;
    }
    layer = {};
  });
  resize_on_all_threads(ahead_, cells);
  for_each_layer([&](std::size_t k) {
    for (std::size_t j = 0; j < rows; ++j) find_ahead(static_cast<std::int64_t>(j), static_cast<std::int64_t>(k));
  });
}

// Both rows are walked along at once.
void SurfaceCells::find_ahead(std::int64_t j, std::int64_t k) {
  const std::uint32_t begin = row_begin(j, k), end = row_end(j, k);
  if (begin == end) return;  // as in the last rows and layers
  for (std::size_t row = 0; row < 3; ++row) {
    const std::int64_t beside = j + static_cast<std::int64_t>((row + 1) & 1U);
    const std::int64_t above = k + static_cast<std::int64_t>((row + 1) >> 1U);
    const std::uint32_t last = row_end(beside, above);
    std::uint32_t at = row_begin(beside, above);
    for (std::uint32_t cell = begin; cell < end; ++cell) {
      while (at < last && cells_[at].node[0] < cells_[cell].node[0]) ++at;
      ahead_[cell][row] = at;
    }
  }
}

Vec3 SurfaceCells::position(const std::array<std::int64_t, 3>& node) const {
  return {lattice_.coordinate(0, lattice_.index_min[0] + node[0]),
          lattice_.coordinate(1, lattice_.index_min[1] + node[1]),
          lattice_.coordinate(2, lattice_.index_min[2] + node[2])};
}

std::uint32_t SurfaceCells::first_from(std::uint32_t begin, std::uint32_t end, std::int64_t x) const {
  const auto first = cells_.begin() + begin, last = cells_.begin() + end;
  const auto found =
      std::lower_bound(first, last, x, [](const SurfaceCell& cell, std::int64_t at) { return cell.node[0] < at; });
  return static_cast<std::uint32_t>(found - cells_.begin());
}

}  // namespace raycone
