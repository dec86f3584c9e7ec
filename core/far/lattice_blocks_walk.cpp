#include "core/far/lattice_blocks_walk.h"

namespace raycone {

void LatticeBlocksWalk::evaluate(const SampleBlock& block, const std::array<SampleRange, 3>& part,
                                 const LatticeBlocks::Sink& sink) const {
  const std::size_t degree =
      block.field ? truncation(block.field->coefficients, kTruncationShare * blocks_.tolerance_).degree : 0;
  GridValues grid(matrices_);
  std::vector<double> numbers;
  std::array<std::size_t, 3> first, last, begin, end;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first[axis] = std::max<std::size_t>(block.first[axis], part[axis].begin);
    last[axis] = std::min<std::size_t>(block.last[axis], part[axis].end);
  }
  // Sub-blocks begin where they do for the whole block.
  const auto after = [&](std::size_t axis, std::size_t at) {
    return std::min(last[axis], at + kSubBlock[axis] - (at - block.first[axis]) % kSubBlock[axis]);
  };
  const auto coordinates = [&](std::size_t axis) {
    return std::span(axes_[axis]).subspan(begin[axis], end[axis] - begin[axis]);
  };
  for (begin[2] = first[2]; begin[2] < last[2]; begin[2] = end[2]) {
    end[2] = after(2, begin[2]);
    begin[0] = first[0], end[0] = last[0], begin[1] = first[1], end[1] = last[1];
    const BlockSums sums{numbers, begin, end};
    if (block.field) {
      const std::size_t samples = (last[0] - first[0]) * (last[1] - first[1]) * (end[2] - begin[2]);
      blocks_.far_terms_.fetch_add(samples, std::memory_order_relaxed);
      const auto values = grid.evaluate(block.field->coefficients, degree, block.field->cube, coordinates(0),
                                        coordinates(1), coordinates(2));
      numbers.assign(values.begin(), values.end());
    } else {
      numbers.assign(sums.row_size() * (last[1] - first[1]) * (end[2] - begin[2]), 0.0);
    }
    for (begin[1] = first[1]; begin[1] < last[1] && !block.near.empty(); begin[1] = end[1]) {
      end[1] = after(1, begin[1]);
      for (begin[0] = first[0]; begin[0] < last[0]; begin[0] = end[0]) {
        end[0] = after(0, begin[0]);
        add_near(block, begin, end, sums);
      }
    }
    for (std::size_t z = begin[2]; z < end[2]; ++z) {
      for (std::size_t y = first[1]; y < last[1]; ++y) {
        sink(first[0], y, z, std::span(numbers).subspan(sums.place(first[0], y, z), last[0] - first[0]));
      }
    }
  }
}

// Which nodes are far is a matter of the whole sub-block, whatever part of it is asked for.
void LatticeBlocksWalk::add_near(const SampleBlock& block, const std::array<std::size_t, 3>& begin,
                                 const std::array<std::size_t, 3>& end, const BlockSums& sums) const {
  std::array<std::size_t, 3> first, last;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first[axis] = begin[axis] - (begin[axis] - block.first[axis]) % kSubBlock[axis];
    last[axis] = std::min(block.last[axis], first[axis] + kSubBlock[axis]);
  }
  const Cover cover = cover_at_samples(block, first, last);
  count_terms(cover, (end[0] - begin[0]) * (end[1] - begin[1]) * (end[2] - begin[2]));
  CoverSums cover_sums(blocks_.tree_, cover, box_of(first, last), shared_corners_, far_);
  SampleTile tile;
  for (std::size_t z = begin[2]; z < end[2]; ++z) {
    tile.clear();
    for (std::size_t y = begin[1]; y < end[1]; ++y) {
      for (std::size_t i = 0; i < kSubBlock[0]; ++i) {
        tile.add({axes_[0][std::min(begin[0] + i, end[0] - 1)], axes_[1][y], axes_[2][z]});
      }
    }
    cover_sums.evaluate(tile, TileShape::kInRows, [&](std::size_t i, double turns, double rest) {
      const std::size_t in_row = i % kSubBlock[0];
      if (begin[0] + in_row >= end[0]) return;
      double& sum = sums.numbers[sums.place(begin[0] + in_row, begin[1] + i / kSubBlock[0], z)];
      sum = turns + (rest + sum);
    });
  }
}

}  // namespace raycone
