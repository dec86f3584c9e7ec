// Blocks of a lattice, with the caps and cones that cut them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/boundary/flat_piece.h"
#include "core/crossings/lattice_rows.h"
#include "core/data/sample_box.h"

namespace raycone {

// Which pieces of caps may come into the box that the samples span and, where there are any, which cones.
struct CutBlock {
  SampleBox samples;
  std::vector<std::uint32_t> caps{}, cones{};

  [[nodiscard]] bool is_row() const { return samples.side(1) == 1 && samples.side(2) == 1; }
  // Whether both come in. No cone begins or ends along a row: all of it is in one, or none of it.
  [[nodiscard]] bool is_cut() const { return !caps.empty() && !cones.empty() && !is_row(); }
};

inline constexpr std::size_t kLargestBlockSide = 64;  // samples

// Const calls are thread-safe.
class CutBlocks {
 public:
  // All are in one scale. `rows` must outlive this, as must `caps`; `cones` are bounded but towards lower x.
  CutBlocks(const LatticeRows& rows, std::span<const FlatPiece> caps, std::vector<FlatPiece> cones);

  // How many largest blocks there are, which together are the lattice.
  [[nodiscard]] std::size_t size() const { return boxes_.size(); }
  // Its pieces are those of a whole column of blocks along x.
  [[nodiscard]] CutBlock operator[](std::size_t n) const;

  // Forgets pieces that do not come into `box`, that of the block.
  void forget_others(CutBlock& block, const Box& box) const;

  // Adds parts of the block, which has more than one sample: halves of its longer sides, of all sides but that along x
  // where it is cut and short, so that rows are left at last.
  void divide(CutBlock block, std::vector<CutBlock>& parts) const;

 private:
  using Columns = std::vector<std::vector<std::uint32_t>>;
  [[nodiscard]] Columns by_column(std::span<const FlatPiece> pieces) const;

  const LatticeRows& rows_;
  std::span<const FlatPiece> caps_;
  std::vector<FlatPiece> cones_;
  const SampleBoxes boxes_;
  Columns columns_of_caps_, columns_of_cones_;
};

}  // namespace raycone
