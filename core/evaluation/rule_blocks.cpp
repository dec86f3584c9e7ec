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
constexpr std::size_t kFew = 4;
constexpr std::size_t kRow = 32;
constexpr double kMostChange = 0.5;  // turns, from a sample: more is hardly ever below the distance from a threshold

// Of interpolation between corners: the largest blocks, and by how much it may be off, turns. It leaves the more
// samples undecided the larger a block is; of a smaller one, corners are too many of its samples.
constexpr std::size_t kInterpolated = 1024;
constexpr double kMostBend = 0.04;

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

// A block in which the rest is smooth: w less the crossings of the closed mesh or, in a row, which does not pass
// through the cone, less those of the mesh. It is known well enough once it is known at one sample, or at all corners.
struct Candidate {
  Block block;
  bool closed;
  double change;  // from the sample in the middle to others at most, turns
  double bend;    // from what is interpolated between the corners, likewise
  std::vector<std::array<std::size_t, 3>> samples;
  std::array<double, 8> rest{};  // at each of them
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
      std::vector<Candidate> interpolated;
      for (Candidate& candidate : candidates) {
        if (decide(candidate)) continue;
        if (candidate.block.size() <= kInterpolated && candidate.bend <= kMostBend) {
          candidate.samples = corners_of(candidate.block);
          interpolated.push_back(std::move(candidate));
        } else {
          divide(std::move(candidate.block), parts);
        }
      }
      evaluate(interpolated);
      for (const Candidate& candidate : interpolated) interpolate(candidate, undecided);
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

  // Whether numbers of turns that are off by less than `needed` are on w's side.
  [[nodiscard]] bool is_certain(double w, double needed) const {
    return distance_to_threshold(side_.rule(), w) - kRounding * std::abs(w) > needed;
  }

  // A number for each corner: bit a is set on the upper side of axis a. visit(number, which of those that are told from
  // others it is).
  template <class Visit>
  static void for_each_corner(const Block& block, const Visit& visit) {
    std::size_t flat = 0, next = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) flat |= (block.count(axis) == 1 ? 1U : 0U) << axis;
    std::array<std::size_t, 8> which{};
    for (std::size_t n = 0; n < 8; ++n) {
      which[n] = (n & flat) == 0 ? next++ : which[n & ~flat];
      visit(n, which[n]);
    }
  }
  [[nodiscard]] static std::vector<std::array<std::size_t, 3>> corners_of(const Block& block) {
    std::vector<std::array<std::size_t, 3>> corners;
    for_each_corner(block, [&](std::size_t n, std::size_t which) {
      if (which < corners.size()) return;
      corners.push_back(block.first);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if ((n >> axis & 1) != 0) corners.back()[axis] = block.last[axis] - 1;
      }
    });
    return corners;
  }

  [[nodiscard]] Block block(std::size_t n) const;
  void sort_caps();
  void look_at(Block block, std::vector<Candidate>& candidates, std::vector<Block>& parts,
               std::vector<Block>& undecided) const;
  [[nodiscard]] Candidate candidate_of(Block block, const Box& box) const;
  void evaluate_each(const Block& whole, std::span<const Block> blocks) const;
  void evaluate(std::span<Candidate> candidates) const;
  [[nodiscard]] bool decide(const Candidate& candidate) const;
  void interpolate(const Candidate& candidate, std::vector<Block>& undecided) const;
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
    Candidate candidate = candidate_of(std::move(block), box);
    if (candidate.change <= kMostChange) {
      candidates.push_back(std::move(candidate));
      return;
    }
    block = std::move(candidate.block);
  }
  divide(std::move(block), parts);
}

// A multilinear interpolation is off by an eighth of the squares of the block's extents times the second derivatives.
Candidate RuleBlocks::candidate_of(Block block, const Box& box) const {
  Candidate candidate{std::move(block), false, 0.0, 0.0, {{}}};
  candidate.closed = candidate.block.caps.empty();
  double to_farthest = 0.0, extents = 0.0;  // squares
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double lower = box.lower[static_cast<int>(axis)], upper = box.upper[static_cast<int>(axis)];
    std::size_t& middle = candidate.samples.front()[axis];
    middle = candidate.block.first[axis] + candidate.block.count(axis) / 2;
    const double x = coordinates(axis)[middle], extent = std::max(x - lower, upper - x);
    to_farthest += extent * extent;
    extents += (upper - lower) * (upper - lower);
  }
  const double radius = std::sqrt(to_farthest);
  const ChangeBound::Bounds bounds = changes_.in(box, kMostChange / radius);
  candidate.change = radius * bounds.gradient * (1 + kRounding);
  candidate.bend = extents / 8 * bounds.second * (1 + kRounding);
  return candidate;
}

void RuleBlocks::evaluate(std::span<Candidate> candidates) const {
  struct Place {
    Candidate* candidate;
    std::size_t sample;
  };
  std::vector<Place> places;
  for (Candidate& candidate : candidates) {
    for (std::size_t n = 0; n < candidate.samples.size(); ++n) places.push_back({&candidate, n});
  }
  LatticeTile tile(mesh_, [&](std::size_t index, const Vec3&, double w) {
    const auto [candidate, n] = places[index];
    candidate->rest[n] = w - crossings_at(candidate->samples[n], candidate->closed);
  });
  for (std::size_t index = 0; index < places.size(); ++index) {
    const std::array<std::size_t, 3>& sample = places[index].candidate->samples[places[index].sample];
    tile.add(index, query(sample), static_cast<std::int64_t>(crossings_at(sample, false)));
  }
  tile.evaluate();
}

// Sets the sides of the candidate's samples if they are certain.
bool RuleBlocks::decide(const Candidate& candidate) const {
  const double rest = candidate.rest[0];
  const double needed = candidate.change + mesh_.doubt() + kRounding * (1 + std::abs(rest));
  return for_each_run(candidate.block, candidate.closed, [&](std::size_t begin, std::size_t end, double n) {
    const double w = n + rest;
    if (!is_certain(w, needed)) return false;
    std::fill(sides_.begin() + static_cast<std::ptrdiff_t>(begin), sides_.begin() + static_cast<std::ptrdiff_t>(end),
              holds(side_.rule(), w) ? 1 : 0);
    return true;
  });
}

// Sets the sides that are certain by interpolation between the corners. Adds the other samples, in runs.
void RuleBlocks::interpolate(const Candidate& candidate, std::vector<Block>& undecided) const {
  const Block& block = candidate.block;
  std::array<double, 8> r;  // at all corners
  for_each_corner(block, [&](std::size_t n, std::size_t which) { r[n] = candidate.rest[which]; });
  double largest = 0.0;
  for (const double rest : r) largest = std::max(largest, std::abs(rest));
  const double needed = candidate.bend + mesh_.doubt() + 8 * kRounding * (1 + largest);
  const auto fraction = [&](std::size_t axis, std::size_t i) {
    const std::vector<double>& all = coordinates(axis);
    const double first = all[block.first[axis]], last = all[block.last[axis] - 1];
    return last > first ? (all[i] - first) / (last - first) : 0.0;
  };
  const auto between = [](double a, double b, double t) { return a + t * (b - a); };
  for (std::size_t k = block.first[2]; k < block.last[2]; ++k) {
    for (std::size_t j = block.first[1]; j < block.last[1]; ++j) {
      const double y = fraction(1, j), z = fraction(2, k);
      const double lower = between(between(r[0], r[2], y), between(r[4], r[6], y), z);
      const double upper = between(between(r[1], r[3], y), between(r[5], r[7], y), z);
      const std::size_t row = row_of(j, k) * rows_.xs.size();
      const Block part{{block.first[0], j, k}, {block.last[0], j + 1, k + 1}, {}};
      for_each_run(part, candidate.closed, [&](std::size_t begin, std::size_t end, double n) {
        for (std::size_t i = begin - row; i < end - row; ++i) {
          const double w = n + between(lower, upper, fraction(0, i));
          if (is_certain(w, needed)) {
            sides_[row + i] = holds(side_.rule(), w) ? 1 : 0;
          } else if (i > begin - row && !undecided.empty() && undecided.back().last == std::array{i, j + 1, k + 1}) {
            ++undecided.back().last[0];  // of the same run
          } else {
            undecided.push_back({{i, j, k}, {i + 1, j + 1, k + 1}, {}});
          }
        }
        return true;
      });
    }
  }
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
