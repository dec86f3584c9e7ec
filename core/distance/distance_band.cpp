// Blocks of samples are halved as long as a triangle may be near, down to those that the kernel takes. Where a lattice
// is coarse for its mesh, a block is near so many triangles that its samples are searched for one by one instead.
#include "core/distance/distance_band.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/distance/block_kernel.h"
#include "core/distance/triangle_distance.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();

// What a search from a sample takes, and for each pack that it has to look at. The unit is what the kernel takes for a
// pack near its block. From afar half-spaces tell more: there it takes 2 r / (2 r + distance) of that, r being the
// radius of the block. Measured with AVX-512 on six meshes of 1500 to 1e6 triangles.
constexpr double kSearch = 0.3, kPackOfSearch = 0.025;

// Where blocks begin along an axis, behind the first one.
class BlockEnds {
 public:
  explicit BlockEnds(std::size_t phase) : phase_(phase) {}
  // Blocks that samples [begin, end) are in.
  [[nodiscard]] std::size_t count(std::size_t begin, std::size_t end) const {
    return (end - 1 + phase_) / kBlockSide - (begin + phase_) / kBlockSide + 1;
  }
  // The first sample of the block that is so many behind that of `sample`, at least one.
  [[nodiscard]] std::size_t behind(std::size_t sample, std::size_t blocks) const {
    return ((sample + phase_) / kBlockSide + blocks) * kBlockSide - phase_;
  }

 private:
  std::size_t phase_;
};

// visit(j, k) for the rows of a box.
template <class Visit>
void for_each_row(const SampleBox& box, const Visit& visit) {
  for (std::size_t k = box.begin[2]; k < box.end[2]; ++k) {
    for (std::size_t j = box.begin[1]; j < box.end[1]; ++j) visit(j, k);
  }
}

class Descent {
 public:
  Descent(const DistanceTree& tree, const LatticeRows& rows, double band, const BlockPhase& phase,
          const BandVisitor& visitor)
      : tree_(tree),
        rows_(rows),
        band_(band),
        ends_{BlockEnds(phase[0]), BlockEnds(phase[1]), BlockEnds(phase[2])},
        visitor_(visitor),
        fill_block_(block_kernel(tree.simd())) {}

  // `distance`: of `from`, or infinity where it is not known.
  void fill(const SampleBox& block, const Vec3& from, double distance) {
    const Box box = rows_.box_of(block);
    const Vec3 center = 0.5 * (box.lower + box.upper);
    const double radius = std::max(norm(center - box.lower), norm(box.upper - center));
    // Where the band is narrow, no distance from the middle says more than the band does: boxes serve better.
    const bool is_narrow = band_ <= radius;
    const double reach = std::min(band_ + radius, distance + norm(center - from));
    const double square = is_narrow ? kNowhere : square_within(reach, center);
    if (square == kNowhere && !is_narrow) return visitor_.beyond(block);
    const double here = std::sqrt(square);
    const double block_reach = std::min(band_, here + radius) * kReachSlack;
    const std::size_t axis = longest_axis(block);
    const std::size_t blocks = ends_[axis].count(block.begin[axis], block.end[axis]);
    if (blocks == 1 || is_narrow) {
      const std::size_t most = blocks == 1 ? std::numeric_limits<std::size_t>::max() : 1;
      tree_.find_packs(box, beyond_error(block_reach * block_reach), most, scratch_.packs);
      if (scratch_.packs.empty()) return visitor_.beyond(block);
    }
    if (blocks == 1) {
      if (!fill_by_searches(block, center, radius))
        fill_block_({tree_, rows_, block, block_reach, scratch_.packs}, scratch_);
      return visitor_.block(block, scratch_.squares);
    }
    const std::size_t middle = ends_[axis].behind(block.begin[axis], (blocks + 1) / 2);
    for (const bool upper : {false, true}) {
      SampleBox half = block;
      (upper ? half.begin : half.end)[axis] = middle;
      fill(half, center, here);
    }
  }

 private:
  // The squared distance of a triangle from q: of the nearest, if it is within `reach`. Infinite where none was found.
  [[nodiscard]] double square_within(double reach, const Vec3& q) const {
    reach *= kReachSlack;
    return tree_.squared_distance(q, reach * reach);
  }

  // Sets scratch_.squares as the kernel would, by a search for each sample, if that takes less time; whether it did.
  // scratch_.packs are those near the block, whose samples are within `radius` of `center`.
  bool fill_by_searches(const SampleBox& block, const Vec3& center, double radius) {
    const double packs = static_cast<double>(scratch_.packs.size()) / static_cast<double>(block.size());
    if (packs < kSearch) return false;
    const double here = std::sqrt(square_within(band_, center));
    const double reach = std::min(band_, here) * kReachSlack;
    const double most = (packs * 2 * radius / (2 * radius + reach) - kSearch) / kPackOfSearch;
    tree_.find_packs({center, center}, beyond_error(reach * reach), scratch_.packs.size(), searched_);
    if (static_cast<double>(searched_.size()) > most) return false;
    scratch_.squares.fill(kNowhere);
    for_each_row(block, [&](std::size_t j, std::size_t k) {
      Vec3 last = center;
      double distance = here;
      for (std::size_t i = block.begin[0]; i < block.end[0]; ++i) {
        const Vec3 q{rows_.xs[i], rows_.ys[j], rows_.zs[k]};
        const double square = square_within(std::min(band_, distance + norm(q - last)), q);
        scratch_.squares[place_in_block({i - block.begin[0], j - block.begin[1], k - block.begin[2]})] = square;
        distance = std::sqrt(square);
        last = q;
      }
    });
    return true;
  }

  // In blocks.
  [[nodiscard]] std::size_t longest_axis(const SampleBox& box) const {
    const auto blocks = [&](std::size_t axis) { return ends_[axis].count(box.begin[axis], box.end[axis]); };
    const std::size_t xy = blocks(0) >= blocks(1) ? 0 : 1;
    return blocks(xy) >= blocks(2) ? xy : 2;
  }

  const DistanceTree& tree_;
  const LatticeRows& rows_;
  double band_;
  std::array<BlockEnds, 3> ends_;
  const BandVisitor& visitor_;
  BlockKernel fill_block_;
  BlockScratch scratch_;
  std::vector<std::uint32_t> searched_;
};

}  // namespace

void visit_band(const DistanceTree& tree, const LatticeRows& rows, double band, const BlockPhase& phase,
                std::size_t axis, const BandVisitor& visitor) {
  const BlockEnds ends(phase[axis]);
  const SampleBox all{{0, 0, 0}, {rows.xs.size(), rows.ys.size(), rows.zs.size()}};
  const std::size_t count = all.end[axis];
  parallel_for(ends.count(0, count), 1, [&](std::size_t first, std::size_t last) {
    Descent descent(tree, rows, band, phase, visitor);
    for (std::size_t n = first; n < last; ++n) {
      SampleBox strip = all;
      strip.begin[axis] = n == 0 ? 0 : ends.behind(0, n);
      strip.end[axis] = std::min(ends.behind(0, n + 1), count);
      descent.fill(strip, {}, kNowhere);
    }
  });
}

void fill_band(const DistanceTree& tree, const LatticeRows& rows, double band, const BandNumbers& which,
               std::span<double> numbers) {
  // The numbers of a row of a box.
  const auto row_of = [&](const SampleBox& box, std::size_t j, std::size_t k) {
    return numbers.subspan((k * rows.ys.size() + j) * rows.xs.size() + box.begin[0], box.side(0));
  };
  BandVisitor visitor;
  visitor.beyond = [&](const SampleBox& box) {
    for_each_row(box, [&](std::size_t j, std::size_t k) { std::ranges::fill(row_of(box, j, k), which.beyond); });
  };
  visitor.block = [&](const SampleBox& box, std::span<double, kSamplesOfBlock> squares) {
    which.finish(squares);
    for_each_row(box, [&](std::size_t j, std::size_t k) {
      const std::span<double> row = row_of(box, j, k);
      const std::size_t first = place_in_block({0, j - box.begin[1], k - box.begin[2]});
      std::copy_n(squares.begin() + static_cast<std::ptrdiff_t>(first), row.size(), row.begin());
    });
  };
  const std::size_t longer = rows.ys.size() >= rows.zs.size() ? 1 : 2;  // slabs may be a few samples thick
  visit_band(tree, rows, band, {}, longer, visitor);
}

}  // namespace raycone
