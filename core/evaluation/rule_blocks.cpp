#include "core/evaluation/rule_blocks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>
#include <vector>

#include "core/boundary/change_bound.h"
#include "core/evaluation/lattice_tile.h"
#include "core/evaluation/side_of.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// In samples: the sides of the blocks that are begun with, blocks so small that no certificate is sought for them, and
// rows that are worth one.
constexpr std::array<std::size_t, 3> kSides{kTile, 32, 32};
constexpr std::size_t kFew = 16;
constexpr std::size_t kRow = 32;
constexpr double kMostChange = 0.5;  // turns, from a sample: more is hardly ever below the distance from a threshold

// Rounding of sums and differences of a few numbers of turns, beside the doubt of values; times their magnitude.
constexpr double kRounding = 1e-12;

// Samples [first, last) along each axis, and which pieces of wide loops' caps may come into their box.
struct Block {
  std::array<std::size_t, 3> first, last;
  std::vector<std::uint32_t> caps;

  [[nodiscard]] std::size_t count(std::size_t axis) const { return last[axis] - first[axis]; }
  [[nodiscard]] std::size_t size() const { return count(0) * count(1) * count(2); }
  [[nodiscard]] bool is_row() const { return count(1) == 1 && count(2) == 1; }
};

// A block in which `rest` is known well enough once it is known at one sample: w less the crossings of the closed mesh,
// or, in a row, which does not pass through the cone, less those of the mesh.
struct Candidate {
  Block block;
  bool closed;
  std::array<std::size_t, 3> sample;
  double change;      // from this sample to others at most, turns
  double rest = 0.0;  // at the sample
};

bool overlap(const Box& a, const Box& b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!(a.lower[axis] <= b.upper[axis] && b.lower[axis] <= a.upper[axis])) return false;
  }
  return true;
}

class RuleBlocks {
 public:
  RuleBlocks(const ScaledMesh& mesh, const LatticeRows& rows, const Rule& rule, const LatticeSums& crossings,
             const LatticeSums& cap_crossings, std::span<std::uint8_t> sides)
      : mesh_(mesh),
        rows_(rows),
        side_(mesh, rule),
        crossings_(crossings),
        cap_crossings_(cap_crossings),
        sides_(sides),
        changes_(mesh.changes().bound) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      blocks_[axis] = (coordinates(axis).size() + kSides[axis] - 1) / kSides[axis];
    }
    sort_caps();
  }

  [[nodiscard]] std::size_t blocks() const { return blocks_[0] * blocks_[1] * blocks_[2]; }

  // Block number n. Returns how many samples it has.
  std::size_t apply(std::size_t n) {
    const Block whole = block(n);
    std::vector<Block> blocks{whole}, undecided;
    if (!worth_it(n)) {
      evaluate_each(whole, blocks);
      return whole.size();
    }
    while (!blocks.empty()) {
      std::vector<Candidate> candidates;
      std::vector<Block> parts;
      for (Block& b : blocks) look_at(std::move(b), candidates, parts, undecided);
      evaluate(candidates);
      for (Candidate& candidate : candidates) {
        if (!decide(candidate)) divide(std::move(candidate.block), parts);
      }
      blocks = std::move(parts);
    }
    evaluate_each(whole, undecided);
    tried_ += whole.size();
    for (const Block& b : undecided) in_vain_ += b.size();
    return whole.size();
  }

 private:
  [[nodiscard]] const std::vector<double>& coordinates(std::size_t axis) const {
    return axis == 0 ? rows_.xs : axis == 1 ? rows_.ys : rows_.zs;
  }
  [[nodiscard]] Box box_of(const Block& block) const {
    Box box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.lower[static_cast<int>(axis)] = coordinates(axis)[block.first[axis]];
      box.upper[static_cast<int>(axis)] = coordinates(axis)[block.last[axis] - 1];
    }
    return box;
  }
  [[nodiscard]] std::size_t row_of(std::size_t j, std::size_t k) const { return k * rows_.ys.size() + j; }
  [[nodiscard]] Vec3 query(const std::array<std::size_t, 3>& sample) const {
    return {rows_.xs[sample[0]], rows_.ys[sample[1]], rows_.zs[sample[2]]};
  }

  // Of the mesh less its caps, which is closed, or of the mesh.
  [[nodiscard]] double crossings_at(const std::array<std::size_t, 3>& sample, bool closed) const {
    const std::size_t row = row_of(sample[1], sample[2]);
    return crossings_.runs(row).at(sample[0]) - (closed ? cap_crossings_.runs(row).at(sample[0]) : 0.0);
  }

  // visit(begin, end of the indices, crossings) for runs of samples whose crossings are the same, as long as it returns
  // true. Returns whether it always did.
  template <class Visit>
  bool for_each_run(const Block& block, bool closed, const Visit& visit) const {
    for (std::size_t k = block.first[2]; k < block.last[2]; ++k) {
      for (std::size_t j = block.first[1]; j < block.last[1]; ++j) {
        const std::size_t row = row_of(j, k), index = row * rows_.xs.size();
        const bool all = crossings_.runs(row).for_each(
            block.first[0], block.last[0], [&](std::size_t begin, std::size_t end, double n) {
              if (!closed) return visit(index + begin, index + end, n);
              return cap_crossings_.runs(row).for_each(begin, end, [&](std::size_t from, std::size_t to, double caps) {
                return visit(index + from, index + to, n - caps);
              });
            });
        if (!all) return false;
      }
    }
    return true;
  }
  // Whether certificates are found often enough; where not, few blocks still look for them. The work depends on it, the
  // sides do not.
  [[nodiscard]] bool worth_it(std::size_t n) const {
    constexpr std::size_t kFewBlocks = 64;
    return n % kFewBlocks == 0 || in_vain_ <= tried_ - tried_ / 8;
  }

  [[nodiscard]] Block block(std::size_t n) const;
  void sort_caps();
  void look_at(Block block, std::vector<Candidate>& candidates, std::vector<Block>& parts,
               std::vector<Block>& undecided) const;
  void evaluate_each(const Block& whole, std::span<const Block> blocks) const;
  void evaluate(std::span<Candidate> candidates) const;
  [[nodiscard]] bool decide(const Candidate& candidate) const;
  void divide(Block block, std::vector<Block>& parts) const;

  const ScaledMesh& mesh_;
  const LatticeRows& rows_;
  const SideOf side_;
  const LatticeSums& crossings_;
  const LatticeSums& cap_crossings_;
  std::span<std::uint8_t> sides_;
  const ChangeBound& changes_;
  std::atomic<std::size_t> tried_ = 0, in_vain_ = 0;  // samples
  std::array<std::size_t, 3> blocks_;                 // per axis
  std::vector<std::vector<std::uint32_t>> columns_;   // the pieces of caps that project into a column of blocks along x
};

Block RuleBlocks::block(std::size_t n) const {
  const std::array<std::size_t, 3> number{n % blocks_[0], n / blocks_[0] % blocks_[1], n / blocks_[0] / blocks_[1]};
  Block block;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    block.first[axis] = number[axis] * kSides[axis];
    block.last[axis] = std::min(block.first[axis] + kSides[axis], coordinates(axis).size());
  }
  block.caps = columns_[number[2] * blocks_[1] + number[1]];
  return block;
}

void RuleBlocks::sort_caps() {
  // The blocks whose boxes may meet [lower, upper].
  const auto range = [&](std::size_t axis, double lower, double upper) {
    const std::vector<double>& all = coordinates(axis);
    const auto first = static_cast<std::size_t>(std::ranges::lower_bound(all, lower) - all.begin());
    const auto last = static_cast<std::size_t>(std::ranges::upper_bound(all, upper) - all.begin());
    return std::array{(std::max<std::size_t>(first, 1) - 1) / kSides[axis],
                      std::min(last, all.size() - 1) / kSides[axis]};
  };
  columns_.resize(blocks_[1] * blocks_[2]);
  const std::span<const Box> pieces = changes_.wide_caps();
  for (std::uint32_t piece = 0; piece < pieces.size(); ++piece) {
    const Box& box = pieces[piece];
    const auto [y_first, y_last] = range(1, box.lower.y, box.upper.y);
    const auto [z_first, z_last] = range(2, box.lower.z, box.upper.z);
    for (std::size_t z = z_first; z <= z_last; ++z) {
      for (std::size_t y = y_first; y <= y_last; ++y) columns_[z * blocks_[1] + y].push_back(piece);
    }
  }
}

// Makes it a candidate, or divides it, or gives it up.
void RuleBlocks::look_at(Block block, std::vector<Candidate>& candidates, std::vector<Block>& parts,
                         std::vector<Block>& undecided) const {
  if (block.size() <= kFew) {
    block.caps.clear();
    undecided.push_back(std::move(block));
    return;
  }
  const Box box = box_of(block);
  std::erase_if(block.caps, [&](std::uint32_t piece) { return !overlap(box, changes_.wide_caps()[piece]); });
  if (block.caps.empty() || block.is_row()) {
    Candidate candidate{std::move(block), false, {}, 0.0};
    candidate.closed = candidate.block.caps.empty();
    double square = 0.0;  // of the distance to the farthest corner
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::vector<double>& all = coordinates(axis);
      candidate.sample[axis] = candidate.block.first[axis] + candidate.block.count(axis) / 2;
      const double x = all[candidate.sample[axis]];
      const double extent = std::max(x - all[candidate.block.first[axis]], all[candidate.block.last[axis] - 1] - x);
      square += extent * extent;
    }
    const double radius = std::sqrt(square);
    candidate.change = radius * changes_.in(box, kMostChange / radius) * (1 + kRounding);
    if (candidate.change <= kMostChange) {
      candidates.push_back(std::move(candidate));
      return;
    }
    block = std::move(candidate.block);
  }
  divide(std::move(block), parts);
}

void RuleBlocks::evaluate(std::span<Candidate> candidates) const {
  for (std::size_t begin = 0; begin < candidates.size(); begin += kTile) {
    const std::span<Candidate> some = candidates.subspan(begin, std::min(kTile, candidates.size() - begin));
    SampleTile tile;
    std::array<std::int64_t, kTile> crossings{};
    std::array<double, kTile> w;
    tile.clear();
    for (std::size_t i = 0; i < some.size(); ++i) {
      tile.add(query(some[i].sample));
      crossings[i] = static_cast<std::int64_t>(crossings_at(some[i].sample, false));
    }
    mesh_.set_values(tile, {crossings.data(), some.size()}, {w.data(), some.size()});
    for (std::size_t i = 0; i < some.size(); ++i) {
      some[i].rest = w[i] - crossings_at(some[i].sample, some[i].closed);
    }
  }
}

// Sets the sides of the candidate's samples if they are certain.
bool RuleBlocks::decide(const Candidate& candidate) const {
  const double needed = candidate.change + mesh_.doubt() + kRounding * (1 + std::abs(candidate.rest));
  return for_each_run(candidate.block, candidate.closed, [&](std::size_t begin, std::size_t end, double n) {
    const double w = n + candidate.rest;
    if (!(distance_to_threshold(side_.rule(), w) - kRounding * std::abs(w) > needed)) return false;
    std::fill(sides_.begin() + static_cast<std::ptrdiff_t>(begin), sides_.begin() + static_cast<std::ptrdiff_t>(end),
              holds(side_.rule(), w) ? 1 : 0);
    return true;
  });
}

// Row by row: samples that share a ray are cheaper together.
void RuleBlocks::evaluate_each(const Block& whole, std::span<const Block> blocks) const {
  std::vector<std::vector<SampleRange>> rows(whole.count(1) * whole.count(2));
  for (const Block& block : blocks) {
    for (std::size_t k = block.first[2]; k < block.last[2]; ++k) {
      for (std::size_t j = block.first[1]; j < block.last[1]; ++j) {
        rows[(k - whole.first[2]) * whole.count(1) + j - whole.first[1]].push_back(
            {static_cast<std::uint32_t>(block.first[0]), static_cast<std::uint32_t>(block.last[0])});
      }
    }
  }
  RowTiles tiles(mesh_, [this](std::size_t index, const Vec3& q, double w) { sides_[index] = side_(q, w); });
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const std::size_t j = whole.first[1] + n % whole.count(1), k = whole.first[2] + n / whole.count(1);
    const std::size_t row = row_of(j, k);
    std::size_t samples = 0;
    for (const SampleRange& range : rows[n]) samples += range.size();
    tiles.begin_row(samples);
    for (const SampleRange& range : rows[n]) {
      crossings_.runs(row).for_each(range.begin, range.end, [&](std::size_t begin, std::size_t end, double crossed) {
        for (std::size_t i = begin; i < end; ++i) {
          tiles.add(row * rows_.xs.size() + i, query({i, j, k}), static_cast<std::int64_t>(crossed));
        }
        return true;
      });
    }
  }
  tiles.finish();
}

// Into rows at last where caps come in, else along all of its longer sides.
void RuleBlocks::divide(Block block, std::vector<Block>& parts) const {
  const Box box = box_of(block);
  const Vec3 size = box.upper - box.lower;
  const bool across = !block.caps.empty() && !block.is_row() && block.count(0) <= kRow;
  const double longest = std::max({across ? 0.0 : size.x, size.y, size.z});
  std::vector<Block> pieces{std::move(block)};
  for (std::size_t axis = across ? 1 : 0; axis < 3; ++axis) {
    if (pieces.front().count(axis) < 2 || size[static_cast<int>(axis)] < longest / 2) continue;
    const std::size_t count = pieces.size();
    for (std::size_t n = 0; n < count; ++n) {
      Block upper = pieces[n];
      const std::size_t half = upper.first[axis] + upper.count(axis) / 2;
      pieces[n].last[axis] = upper.first[axis] = half;
      pieces.push_back(std::move(upper));
    }
  }
  std::ranges::move(pieces, std::back_inserter(parts));
}

}  // namespace

void set_sides(const ScaledMesh& mesh, const LatticeRows& rows, const Rule& rule, const LatticeSums& crossings,
               const LatticeSums& cap_crossings, std::span<std::uint8_t> sides, std::atomic<std::uint64_t>* done) {
  RuleBlocks blocks(mesh, rows, rule, crossings, cap_crossings, sides);
  parallel_for(blocks.blocks(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const std::size_t samples = blocks.apply(n);
      if (done) done->fetch_add(samples, std::memory_order_relaxed);
    }
  });
}

}  // namespace raycone
