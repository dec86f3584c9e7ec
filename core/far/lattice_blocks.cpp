#include "core/far/lattice_blocks.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/far/harmonic_fit.h"
#include "core/far/lattice_blocks_walk.h"
#include "core/machine/threads.h"

namespace raycone {

LatticeBlocks::LatticeBlocks(std::vector<SolidTriangle> triangles, double tolerance, SimdLevel level, Near near)
    : tree_(std::move(triangles), LatticeBlocksWalk::kSampleShare * tolerance, level, {}),
      tolerance_(tolerance),
      level_(level) {
  sources_.reserve(tree_.triangles().size());
  for (const SolidTriangle& triangle : tree_.triangles()) sources_.push_back(extent_of(triangle));
  leaf_ends_.reserve(sources_.size());
  for (const SourceNode& node : tree_.nodes()) {
    for (std::uint32_t n = node.begin; n < node.own_end; ++n) {
      leaf_ends_.push_back(node.own_end == node.end ? node.end : n + 1);
    }
  }
  if (near == Near::kBoundary) edges_.emplace(tree_.triangles());
}

namespace {

// The blocks of a part of a lattice.
class PartBlocks {
 public:
  PartBlocks(const LatticeBlocksWalk& walk, const SampleBox& part, const LatticeBlocks::Sink& sink)
      : walk_(walk), part_(part), sink_(sink) {}

  // The parts of a block that are asked for; none if the block is to be evaluated.
  [[nodiscard]] std::vector<SampleBlock> divided(const SampleBlock& block) const {
    LatticeBlocksWalk::Division division = walk_.divide(block), wanted;
    if (!walk_.pays(block, division)) return {};
    for (std::size_t n = 0; n < division.children.size(); ++n) {
      if (!LatticeBlocksWalk::overlap(division.children[n], part_)) continue;
      wanted.children.push_back(std::move(division.children[n]));
      wanted.far.push_back(std::move(division.far[n]));
    }
    walk_.make_fields(wanted);
    return std::move(wanted.children);
  }

  // Divides all of `blocks` once, and moves those that are not divided to `done`.
  void divide_all(std::vector<SampleBlock>& blocks, std::vector<SampleBlock>& done) const {
    std::vector<std::vector<SampleBlock>> parts(blocks.size());
    parallel_for_each(blocks.size(), [&](std::size_t n) { parts[n] = divided(blocks[n]); });
    std::vector<SampleBlock> next;
    for (std::size_t n = 0; n < blocks.size(); ++n) {
      if (parts[n].empty()) done.push_back(std::move(blocks[n]));
      std::ranges::move(parts[n], std::back_inserter(next));
    }
    blocks = std::move(next);
  }

  void evaluate(const SampleBlock& block) const { walk_.evaluate(block, part_, sink_); }

  // Depth first, so that few blocks wait.
  void divide_and_evaluate(SampleBlock all) const {
    std::vector<SampleBlock> waiting;
    waiting.push_back(std::move(all));
    while (!waiting.empty()) {
      const SampleBlock block = std::move(waiting.back());
      waiting.pop_back();
      std::vector<SampleBlock> parts = divided(block);
      if (parts.empty()) evaluate(block);
      std::ranges::move(parts, std::back_inserter(waiting));
    }
  }

 private:
  const LatticeBlocksWalk& walk_;
  const SampleBox& part_;
  const LatticeBlocks::Sink& sink_;
};

}  // namespace

void LatticeBlocks::for_each_row(const LatticeAxes& axes, const SampleBox& part, const Sink& sink) const {
  constexpr std::size_t kEnough = 48;  // blocks for all threads
  const LatticeBlocksWalk walk(*this, axes);
  const PartBlocks of_part(walk, part, sink);
  LatticeBlocksWalk::Division all = walk.whole();
  walk.make_fields(all);
  std::vector<SampleBlock> blocks = std::move(all.children), done;
  while (!blocks.empty() && blocks.size() + done.size() < kEnough) of_part.divide_all(blocks, done);
  parallel_for_each(done.size(), [&](std::size_t n) { of_part.evaluate(done[n]); });
  parallel_for_each(blocks.size(), [&](std::size_t n) { of_part.divide_and_evaluate(std::move(blocks[n])); });
}

void LatticeBlocks::count_terms(const Cover& cover, std::size_t samples) const {
  near_terms_.fetch_add(samples * cover.triangles.size(), std::memory_order_relaxed);
  far_terms_.fetch_add(samples * cover.expansions.size(), std::memory_order_relaxed);
}

// A triangle rounds by 3 2^-41 turns at most, as in other sums; at nodes fits multiply that. Values at nodes, of half a
// turn per triangle at most, are fitted once for each triangle.
double LatticeBlocks::doubt(double tolerance, double triangles) {
  constexpr double kPerTriangle = 3 * 0x1p-41;
  return tolerance + triangles * (kPerTriangle * HarmonicFit::kLargestWeights + HarmonicFit::kRounding / 2);
}

double LatticeBlocks::tree_tolerance() const { return LatticeBlocksWalk::kSampleShare * tolerance_; }

double LatticeBlocks::cost(const LatticeAxes& axes) const { return LatticeBlocksWalk(*this, axes).cost(); }

}  // namespace raycone
