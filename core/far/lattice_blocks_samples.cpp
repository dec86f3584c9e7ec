// The sums at the samples of blocks: polynomials, and what is near.
#include <algorithm>
#include <span>
#include <vector>

#include "core/far/lattice_blocks_walk.h"

namespace raycone {
namespace {

// Where the sub-block ends that `at` is in. Sub-blocks begin where they do for the whole block.
std::size_t end_of_sub_block(const SampleBlock& block, std::size_t axis, std::size_t at) {
  return at + kSubBlock[axis] - (at - block.samples.begin[axis]) % kSubBlock[axis];
}

}  // namespace

void LatticeBlocksWalk::evaluate(const SampleBlock& block, const SampleBox& part,
                                 const LatticeBlocks::Sink& sink) const {
  const std::size_t degree = this->degree(block);
  GridValues grid(matrices_);
  LatticeCovers covers(blocks_.tree_, axes_, kernels_, blocks_.edges_ ? &*blocks_.edges_ : nullptr);
  std::vector<double> numbers;
  SampleBox all, layers;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    all.begin[axis] = std::max(block.samples.begin[axis], part.begin[axis]);
    all.end[axis] = std::min(block.samples.end[axis], part.end[axis]);
  }
  layers = all;
  for (; layers.begin[2] < all.end[2]; layers.begin[2] = layers.end[2]) {
    layers.end[2] = std::min(all.end[2], end_of_sub_block(block, 2, layers.begin[2]));
    const BoxSums sums{numbers, layers};
    set_layers(block, degree, grid, covers, sums);
    for (std::size_t z = layers.begin[2]; z < layers.end[2]; ++z) {
      for (std::size_t y = all.begin[1]; y < all.end[1]; ++y) sink(all.begin[0], y, z, sums.row(y, z));
    }
  }
}

// As many layers along z as a sub-block has: the polynomial up to `degree`, and what is near.
void LatticeBlocksWalk::set_layers(const SampleBlock& block, std::size_t degree, GridValues& grid,
                                   LatticeCovers& covers, const BoxSums& sums) const {
  const SampleBox& all = sums.samples;
  const auto coordinates = [&](std::size_t axis) {
    return std::span(axes_[axis]).subspan(all.begin[axis], all.side(axis));
  };
  if (block.field) {
    count_polynomials(all.size());
    const auto values = grid.evaluate(block.field->coefficients, degree, block.field->cube, coordinates(0),
                                      coordinates(1), coordinates(2));
    sums.numbers.assign(values.begin(), values.end());
  } else {
    sums.numbers.assign(sums.size(), 0.0);
  }
  if (block.near.empty()) return;
  SampleBox part = all;
  for (; part.begin[1] < all.end[1]; part.begin[1] = part.end[1]) {
    part.end[1] = std::min(all.end[1], end_of_sub_block(block, 1, part.begin[1]));
    for (part.begin[0] = all.begin[0]; part.begin[0] < all.end[0]; part.begin[0] = part.end[0]) {
      part.end[0] = std::min(all.end[0], end_of_sub_block(block, 0, part.begin[0]));
      add_near(block, part, covers, sums);
    }
  }
}

// Which nodes are far is a matter of the whole sub-block, whatever part of it is asked for.
void LatticeBlocksWalk::add_near(const SampleBlock& block, const SampleBox& samples, LatticeCovers& covers,
                                 const BoxSums& sums) const {
  SampleBox sub_block;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t before = (samples.begin[axis] - block.samples.begin[axis]) % kSubBlock[axis];
    sub_block.begin[axis] = samples.begin[axis] - before;
    sub_block.end[axis] = std::min(block.samples.end[axis], sub_block.begin[axis] + kSubBlock[axis]);
  }
  const Cover cover = cover_at(block, sub_block);
  count_terms(cover, samples.size());
  covers.add(cover, box_of(sub_block), samples, sums);
}

}  // namespace raycone
