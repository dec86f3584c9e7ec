// The nodes of a lattice that are inside.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/data/lattice.h"
#include "core/data/rule.h"
#include "core/evaluation/winding_number.h"

namespace raycone {

// A bit for each node of a lattice, in rows along x. Nodes are numbered x fastest, from 0.
class NodeSet {
 public:
  using Node = std::array<std::int64_t, 3>;

  // Empty.
  explicit NodeSet(const Lattice& lattice);

  // Threads may set_row() different rows at a time; insert() is for one thread.

  [[nodiscard]] const Lattice& lattice() const { return lattice_; }
  [[nodiscard]] std::int64_t count(int axis) const { return lattice_.counts[static_cast<std::size_t>(axis)]; }

  [[nodiscard]] bool holds(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return (row(j, k)[i / 64] >> (i % 64) & 1U) != 0;
  }
  void insert(std::int64_t i, std::int64_t j, std::int64_t k) {
    words_[static_cast<std::size_t>((k * count(1) + j) * words_per_row_ + i / 64)] |= std::uint64_t{1} << (i % 64);
  }

  // Sets a row to the nodes where `holds` is 1; elsewhere it is 0. Precondition: holds.size() == count(0).
  void set_row(std::int64_t j, std::int64_t k, std::span<const std::uint8_t> holds);

  // The same nodes of another lattice with as many nodes along each axis.
  [[nodiscard]] NodeSet on(const Lattice& lattice) const;

  // The bits of a row, 64 a word; those behind its end are 0.
  [[nodiscard]] const std::uint64_t* row(std::int64_t j, std::int64_t k) const {
    return words_.data() + (k * count(1) + j) * words_per_row_;
  }
  [[nodiscard]] std::int64_t words_per_row() const { return words_per_row_; }

  // Calls visit(node) for each, in the order of their numbers.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t word = 0; word < words_.size(); ++word) {
      const auto row = static_cast<std::int64_t>(word) / words_per_row_;
      const std::int64_t first = (static_cast<std::int64_t>(word) - row * words_per_row_) * 64;
      for (std::uint64_t bits = words_[word]; bits != 0; bits &= bits - 1)
        visit(Node{first + std::countr_zero(bits), row % count(1), row / count(1)});
    }
  }

  // Takes out the nodes of `others` that are in this set, and adds those that are not. Precondition: of the same
  // lattice.
  void flip(const NodeSet& others);

  [[nodiscard]] bool empty() const;
  [[nodiscard]] std::uint64_t size() const;
  // Whether a node of the lattice's outermost layers is in it.
  [[nodiscard]] bool reaches_border() const;

 private:
  Lattice lattice_;
  std::int64_t words_per_row_;
  std::vector<std::uint64_t> words_;
};

// The nodes where `rule` holds. Exact. `done`, where given, grows by one per node, and `tally` by what evaluate_sides()
// counts. Uses the threads that ThreadLimit allows; the same for any number of them.
[[nodiscard]] NodeSet nodes_inside(const WindingNumberEvaluator& evaluator, const Rule& rule, const Lattice& lattice,
                                   std::atomic<std::uint64_t>* done = nullptr, Tally* tally = nullptr);

// The same for the rows of `block`: no nodes are found elsewhere. Precondition: rows of `block` are whole.
[[nodiscard]] NodeSet nodes_inside_of(const LatticeBlock& block, const WindingNumberEvaluator& evaluator,
                                      const Rule& rule, const Lattice& lattice,
                                      std::atomic<std::uint64_t>* done = nullptr, Tally* tally = nullptr);

// What nodes_inside() takes at most, in bytes.
[[nodiscard]] double node_set_bytes(const Lattice& lattice);

}  // namespace raycone
