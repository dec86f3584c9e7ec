#include "core/intersections/pair_tree.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <span>
#include <utility>

#include "core/machine/threads.h"

namespace raycone {

PairTree::PairTree(const TriangleMesh& mesh, std::vector<std::uint32_t> triangles)
    : mesh_(mesh), triangles_(std::move(triangles)) {
  constexpr std::size_t kGrain = 8;
  Level level((triangles_.size() + kWidth - 1) / kWidth);
  std::vector<Box> boxes(level.size());
  parallel_for_each(level.size(), kGrain, [&](std::size_t run) {
    const RunBoxes of_run(*this, run);
    boxes[run] = of_run.all();
    level[run] = of_run.node();
  });
  while (level.size() > 1) {
    levels_.push_back(std::move(level));
    level = level_above(boxes);
  }
  levels_.push_back(std::move(level));
}

PairTree::Level PairTree::level_above(std::vector<Box>& boxes) {
  Level level((boxes.size() + kWidth - 1) / kWidth);
  for (std::size_t n = 0; n < level.size(); ++n) {
    const std::span<const Box> children(boxes.data() + n * kWidth, std::min(kWidth, boxes.size() - n * kWidth));
    const Box all = std::accumulate(children.begin(), children.end(), empty_box(), hull);
    level[n] = BoxNode(children, all);
    boxes[n] = all;  // one of these children, or one that has been taken
  }
  boxes.resize(level.size());
  return level;
}

void PairTree::find_runs(std::size_t level, std::size_t node, std::size_t first, const HalfBox& box,
                         std::vector<std::size_t>& runs) const {
  if (level == 0) {
    runs.push_back(node);
    return;
  }
  const std::size_t first_behind = first >> (3 * (level - 1));  // children before it end before `first`
  unsigned meeting = levels_[level][node].meeting(box);
  for (; meeting != 0; meeting &= meeting - 1) {
    const std::size_t child = node * kWidth + static_cast<std::size_t>(std::countr_zero(meeting));
    if (child >= first_behind) find_runs(level - 1, child, first, box, runs);
  }
}

}  // namespace raycone
