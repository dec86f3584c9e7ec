#include "core/evaluation/cut_blocks.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace raycone {
namespace {

constexpr std::size_t kRow = 32;  // samples: rows that are worth halving no more

}  // namespace

CutBlocks::CutBlocks(const LatticeRows& rows, std::span<const FlatPiece> caps, std::vector<FlatPiece> cones)
    : rows_(rows), caps_(caps), cones_(std::move(cones)), boxes_(rows.counts(), kLargestBlockSide) {
  columns_of_caps_ = by_column(caps_);
  columns_of_cones_ = by_column(cones_);
}

// [column]: what may project into it.
CutBlocks::Columns CutBlocks::by_column(std::span<const FlatPiece> pieces) const {
  // The blocks whose boxes may meet [lower, upper].
  const auto range = [&](std::size_t axis, double lower, double upper) {
    const std::vector<double>& all = rows_.along(axis);
    const auto first = static_cast<std::size_t>(std::ranges::lower_bound(all, lower) - all.begin());
    const auto last = static_cast<std::size_t>(std::ranges::upper_bound(all, upper) - all.begin());
    return std::array{(std::max<std::size_t>(first, 1) - 1) / kLargestBlockSide,
                      std::min(last, all.size() - 1) / kLargestBlockSide};
  };
  const auto overlaps = [&](std::size_t axis, double lower, double upper) {
    return lower <= rows_.along(axis).back() && upper >= rows_.along(axis).front();
  };
  const std::size_t y_count = boxes_.counts()[1], z_count = boxes_.counts()[2];
  Columns columns(y_count * z_count);
  for (std::uint32_t number = 0; number < pieces.size(); ++number) {
    const Box& box = pieces[number].box();
    if (!overlaps(1, box.lower.y, box.upper.y) || !overlaps(2, box.lower.z, box.upper.z)) continue;
    const auto [y_first, y_last] = range(1, box.lower.y, box.upper.y);
    const auto [z_first, z_last] = range(2, box.lower.z, box.upper.z);
    for (std::size_t z = z_first; z <= z_last; ++z) {
      for (std::size_t y = y_first; y <= y_last; ++y) columns[z * y_count + y].push_back(number);
    }
  }
  return columns;
}

CutBlock CutBlocks::operator[](std::size_t n) const {
  CutBlock block{boxes_[n]};
  const std::size_t column = n / boxes_.counts()[0];
  block.caps = columns_of_caps_[column];
  if (!block.caps.empty()) block.cones = columns_of_cones_[column];
  return block;
}

void CutBlocks::forget_others(CutBlock& block, const Box& box) const {
  std::erase_if(block.caps, [&](std::uint32_t piece) { return !caps_[piece].may_meet(box); });
  if (block.caps.empty()) block.cones.clear();
  std::erase_if(block.cones, [&](std::uint32_t cone) { return !cones_[cone].may_meet(box); });
}

void CutBlocks::divide(CutBlock block, std::vector<CutBlock>& parts) const {
  const Box box = rows_.box_of(block.samples);
  const Vec3 size = box.upper - box.lower;
  const bool across = block.is_cut() && block.samples.side(0) <= kRow;
  const double longest = std::max({across ? 0.0 : size.x, size.y, size.z});
  std::vector<CutBlock> pieces{std::move(block)};
  for (std::size_t axis = across ? 1 : 0; axis < 3; ++axis) {
    if (pieces.front().samples.side(axis) < 2 || size[static_cast<int>(axis)] < longest / 2) continue;
    const std::size_t count = pieces.size();
    for (std::size_t n = 0; n < count; ++n) {
      CutBlock upper = pieces[n];
      const std::size_t half = upper.samples.begin[axis] + upper.samples.side(axis) / 2;
      pieces[n].samples.end[axis] = upper.samples.begin[axis] = half;
      pieces.push_back(std::move(upper));
    }
  }
  std::ranges::move(pieces, std::back_inserter(parts));
}

}  // namespace raycone
