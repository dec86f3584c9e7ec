// Blocks of samples are halved as long as a triangle may be near, down to those that the kernel takes.
#include "core/distance/distance_band.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/distance/block_kernel.h"
#include "core/distance/triangle_distance.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();

double length(const Vec3& v) { return std::sqrt(dot(v, v)); }

std::size_t longest_axis(const SampleBox& block) {
  const std::size_t xy = block.side(0) >= block.side(1) ? 0 : 1;
  return block.side(xy) >= block.side(2) ? xy : 2;
}

class Descent {
 public:
  Descent(const DistanceTree& tree, const LatticeRows& rows, double band, const BandNumbers& which,
          std::span<double> numbers)
      : tree_(tree),
        rows_(rows),
        band_(band),
        which_(which),
        numbers_(numbers),
        fill_block_(block_kernel(tree.simd())) {}

  // `distance`: of `from`, or infinity.
  void fill(const SampleBox& block, const Vec3& from, double distance) {
    const Box box{{rows_.xs[block.begin[0]], rows_.ys[block.begin[1]], rows_.zs[block.begin[2]]},
                  {rows_.xs[block.end[0] - 1], rows_.ys[block.end[1] - 1], rows_.zs[block.end[2] - 1]}};
    const Vec3 center = 0.5 * (box.lower + box.upper);
    const double radius = std::max(length(center - box.lower), length(box.upper - center));
    const double reach = std::min(band_ + radius, distance + length(center - from)) * kSlack;
    const double square = tree_.squared_distance(center, reach * reach);
    if (square == kNowhere) return fill_beyond(block);
    const double here = std::sqrt(square);
    const std::size_t axis = longest_axis(block);
    if (block.side(axis) <= kBlockSide) {
      const double block_reach = std::min(band_, here + radius) * kSlack;
      tree_.find_packs(box, beyond_error(block_reach * block_reach), scratch_.packs);
      fill_block_({tree_, rows_, block, block_reach, scratch_.packs}, scratch_);
      return take_numbers(block);
    }
    const std::size_t blocks = (block.side(axis) + kBlockSide - 1) / kBlockSide;
    const std::size_t middle = block.begin[axis] + (blocks + 1) / 2 * kBlockSide;
    for (const bool upper : {false, true}) {
      SampleBox half = block;
      (upper ? half.begin : half.end)[axis] = middle;
      fill(half, center, here);
    }
  }

 private:
  static constexpr double kSlack = 1 + 1e-9;  // more than roundings of sums take; the tree adds those of distances

  // visit(j, k, the numbers of the block's samples) for each of its rows.
  template <class Visit>
  void for_each_row(const SampleBox& block, const Visit& visit) const {
    for (std::size_t k = block.begin[2]; k < block.end[2]; ++k) {
      for (std::size_t j = block.begin[1]; j < block.end[1]; ++j) {
        const std::size_t row = (k * rows_.ys.size() + j) * rows_.xs.size();
        visit(j, k, numbers_.subspan(row + block.begin[0], block.side(0)));
      }
    }
  }
  void fill_beyond(const SampleBox& block) const {
    for_each_row(block,
                 [this](std::size_t, std::size_t, std::span<double> row) { std::ranges::fill(row, which_.beyond); });
  }
  void take_numbers(const SampleBox& block) {
    which_.finish(scratch_.squares);
    for_each_row(block, [&](std::size_t j, std::size_t k, std::span<double> row) {
      const std::size_t first = index_in_block({0, j - block.begin[1], k - block.begin[2]});
      std::copy_n(scratch_.squares.begin() + static_cast<std::ptrdiff_t>(first), row.size(), row.begin());
    });
  }

  const DistanceTree& tree_;
  const LatticeRows& rows_;
  double band_;
  const BandNumbers& which_;
  std::span<double> numbers_;
  BlockKernel fill_block_;
  BlockScratch scratch_;
};

}  // namespace

void fill_band(const DistanceTree& tree, const LatticeRows& rows, double band, const BandNumbers& which,
               std::span<double> numbers) {
  const std::size_t strips = (rows.ys.size() + kBlockSide - 1) / kBlockSide;
  parallel_for(strips, 1, [&](std::size_t first, std::size_t last) {
    Descent descent(tree, rows, band, which, numbers);
    for (std::size_t strip = first; strip < last; ++strip) {
      const std::size_t end = std::min((strip + 1) * kBlockSide, rows.ys.size());
      descent.fill({{0, strip * kBlockSide, 0}, {rows.xs.size(), end, rows.zs.size()}}, {}, kNowhere);
    }
  });
}

}  // namespace raycone
