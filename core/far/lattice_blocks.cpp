#include "core/far/lattice_blocks.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/far/lattice_blocks_walk.h"
#include "core/machine/threads.h"

namespace raycone {

LatticeBlocks::LatticeBlocks(std::vector<SolidTriangle> triangles, double tolerance, SimdLevel level)
    : tree_(std::move(triangles), kSampleShare * tolerance, level), tolerance_(tolerance), level_(level) {
  sources_.reserve(tree_.triangles().size());
  for (const SolidTriangle& t : tree_.triangles()) {
    Source source;
    for (int axis = 0; axis < 3; ++axis) {
      source.box.lower[axis] = std::min({t.a[axis], t.b[axis], t.c[axis]});
      source.box.upper[axis] = std::max({t.a[axis], t.b[axis], t.c[axis]});
    }
    source.area = std::sqrt(dot(t.normal, t.normal)) / 2 * (1 + 0x1p-40);
    sources_.push_back(source);
  }
}

void LatticeBlocks::for_each_row(const LatticeAxes& axes, const std::array<SampleRange, 3>& part,
                                 const Sink& sink) const {
  constexpr std::size_t kEnough = 48;  // blocks for all threads
  const LatticeBlocksWalk walk(*this, axes);
  LatticeBlocksWalk::Division all = walk.whole();
  walk.make_fields(all);
  std::vector<SampleBlock> blocks = std::move(all.children), done;
  // The division of a block, its parts that are asked for; none if the block is to be evaluated.
  const auto divided = [&](const SampleBlock& block) {
    LatticeBlocksWalk::Division division = walk.divide(block), wanted;
    if (!walk.pays(block, division)) return std::vector<SampleBlock>();
    for (std::size_t n = 0; n < division.children.size(); ++n) {
      if (!LatticeBlocksWalk::overlap(division.children[n], part)) continue;
      wanted.children.push_back(std::move(division.children[n]));
      wanted.far.push_back(std::move(division.far[n]));
    }
    walk.make_fields(wanted);
    return std::move(wanted.children);
  };
  while (!blocks.empty() && blocks.size() + done.size() < kEnough) {
    std::vector<std::vector<SampleBlock>> parts(blocks.size());
    parallel_for(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) parts[n] = divided(blocks[n]);
    });
    std::vector<SampleBlock> next;
    for (std::size_t n = 0; n < blocks.size(); ++n) {
      if (parts[n].empty()) done.push_back(std::move(blocks[n]));
      std::ranges::move(parts[n], std::back_inserter(next));
    }
    blocks = std::move(next);
  }
  parallel_for(done.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) walk.evaluate(done[n], part, sink);
  });
  parallel_for(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      std::vector<SampleBlock> waiting{std::move(blocks[n])};
      while (!waiting.empty()) {
        const SampleBlock block = std::move(waiting.back());
        waiting.pop_back();
        std::vector<SampleBlock> children = divided(block);
        if (children.empty()) walk.evaluate(block, part, sink);
        std::ranges::move(children, std::back_inserter(waiting));
      }
    }
  });
}

// A triangle rounds by 3 2^-41 turns at most, as in other sums; at nodes fits multiply that. Values at nodes, of half a
// turn per triangle at most, are fitted once for each triangle.
double LatticeBlocks::doubt(double tolerance, double triangles) {
  constexpr double kPerTriangle = 3 * 0x1p-41;
  return tolerance + triangles * (kPerTriangle * HarmonicFit::kLargestWeights + HarmonicFit::kRounding / 2);
}

double LatticeBlocks::cost(const LatticeAxes& axes) const {
  const LatticeBlocksWalk walk(*this, axes);
  const LatticeBlocksWalk::Division all = walk.whole();
  const SampleBlock& block = all.children.front();
  return (LatticeBlocksWalk::making_cost(all.far.front().cost, false) + walk.estimate(block, 0)) / block.size();
}

}  // namespace raycone
