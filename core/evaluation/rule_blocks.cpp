#include "core/evaluation/rule_blocks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/boundary/change_bound.h"
#include "core/evaluation/lattice_polynomial.h"
#include "core/evaluation/lattice_tile.h"
#include "core/evaluation/side_of.h"
#include "core/far/matrix_kernel.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// In samples: the sides of the blocks that are begun with, blocks so small that no certificate is sought for them, and
// rows that are worth one.
constexpr std::array<std::size_t, 3> kSides{96, 48, 48};
constexpr std::size_t kFew = 4;
constexpr std::size_t kRow = 32;
constexpr std::size_t kHopeless = 8 * kFew;  // where certificates failed: parts are as few as that
constexpr double kMostChange = 0.5;  // turns, from a sample: more is hardly ever below the distance from a threshold

// Of interpolation between nodes: how much it may be off, turns, and what it leaves undecided of a block, relative to
// how much of the change in the block that is (measured). Nodes and samples that are left are counted alike; this share
// of the samples takes as long as interpolation of all.
constexpr double kMostBend = 0.04;
constexpr double kUndecided = 1.0;
constexpr double kInterpolation = 1.0 / 100;
// Larger blocks than this are divided, unless interpolation takes so little, of each.
constexpr std::size_t kSmall = 1024;
constexpr double kWorthIt = 1.0 / 16;

// Rounding of sums and differences of a few numbers of turns, beside the doubt of values; times their magnitude.
constexpr double kRounding = 1e-12;

// Samples [first, last) along each axis. Which pieces of wide loops' caps may come into their box and, where there are
// any, which edges may be met by a ray from it.
struct Block {
  std::array<std::size_t, 3> first, last;
  std::vector<std::uint32_t> caps{}, edges{};

  [[nodiscard]] std::size_t count(std::size_t axis) const { return last[axis] - first[axis]; }
  [[nodiscard]] std::size_t size() const { return count(0) * count(1) * count(2); }
  [[nodiscard]] bool is_row() const { return count(1) == 1 && count(2) == 1; }
  // Whether the rest is smooth in neither of the two ways that a Candidate knows.
  [[nodiscard]] bool is_cut() const { return !caps.empty() && !edges.empty() && !is_row(); }
};

// Samples of a block that polynomials are put through, one axis after the other.
struct NodeGrid {
  std::vector<AxisNodes> along;
  double bend = 0.0;    // turns by which samples are at most off what is interpolated between nodes
  double growth = 1.0;  // of what values at nodes are off by

  [[nodiscard]] std::size_t size(std::size_t axis) const { return along[axis].nodes().size(); }

  // At a sample, by its number along each axis of the block; `values` at nodes.
  [[nodiscard]] double at(std::span<const double> values, const std::array<std::size_t, 3>& sample) const {
    double sum = 0.0;
    for (std::size_t k = 0, n = 0; k < size(2); ++k) {
      double layer = 0.0;
      for (std::size_t j = 0; j < size(1); ++j) {
        double row = 0.0;
        for (std::size_t i = 0; i < size(0); ++i) row += along[0].weights(i)[sample[0]] * values[n++];
        layer += along[1].weights(j)[sample[1]] * row;
      }
      sum += along[2].weights(k)[sample[2]] * layer;
    }
    return sum;
  }
};

// Neighbours in space have codes that are near to each other (Morton).
std::uint64_t code_of(const std::array<std::size_t, 3>& sample) {
  static constexpr auto kSpread = [] {
    std::array<std::uint32_t, 256> spread{};
    for (std::uint32_t n = 0; n < spread.size(); ++n) {
      for (std::uint32_t bit = 0; bit < 8; ++bit) spread[n] |= (n >> bit & 1U) << (3 * bit);
    }
    return spread;
  }();
  std::uint64_t code = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::uint64_t low = kSpread[sample[axis] & 255U], high = kSpread[sample[axis] >> 8U & 255U];
    code |= (low | high << 24U) << axis;
  }
  return code;
}

struct InterpolationScratch {
  std::vector<double> layer, nodes, values;
};

// A block in which the rest is smooth: w less the crossings of the closed mesh where no cap comes in or, where no cone
// does (a row passes through none), less those of the mesh. It is known well enough once it is known at one sample, or
// at some nodes.
struct Candidate {
  Block block;
  bool closed;
  double gradient = 0.0;  // its length is at most this, turns per unit
  double change = 0.0;    // from the sample in the middle to others at most, turns
  NodeGrid nodes{};
  std::vector<std::array<std::size_t, 3>> samples;  // one in the middle, or the nodes
  std::vector<double> rest;                         // at each of them
};

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
        changes_(mesh.changes().bound),
        matrices_(matrix_kernel(mesh.options().level)) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      blocks_[axis] = (coordinates(axis).size() + kSides[axis] - 1) / kSides[axis];
    }
    sort(changes_.wide_caps(), columns_.caps);
    for (const DirectedEdge& edge : mesh.boundary().directed_edges()) {
      cones_.push_back(FlatPiece::cone_of(edge.from, edge.to));
    }
    sort(cones_, columns_.edges);
  }

  [[nodiscard]] std::size_t blocks() const { return blocks_[0] * blocks_[1] * blocks_[2]; }

  // Whether certificates were found often enough so far. The work depends on it, the sides do not.
  [[nodiscard]] bool are_worth_it() const { return in_vain_ <= tried_ - tried_ / 8; }

  // Block number n, by certificates or, but for a few, without. Returns how many samples it has.
  std::size_t apply(std::size_t n, bool by_certificates) {
    constexpr std::size_t kFewBlocks = 64;
    const Block whole = block(n);
    std::vector<Block> blocks{whole}, undecided;
    if (!by_certificates && n % kFewBlocks != 0) {
      evaluate_rows(whole);
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
        if (choose_nodes(candidate)) {
          interpolated.push_back(std::move(candidate));
        } else if (candidate.block.size() <= kHopeless) {
          undecided.push_back({candidate.block.first, candidate.block.last});
        } else {
          divide(std::move(candidate.block), parts);
        }
      }
      evaluate(interpolated);
      for (const Candidate& candidate : interpolated) interpolate(candidate, undecided);
      blocks = std::move(parts);
    }
    evaluate_each(undecided);
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

  template <class Tile>
  void add(Tile& tile, std::size_t index, const std::array<std::size_t, 3>& sample) const {
    const std::size_t row = row_of(sample[1], sample[2]);
    tile.add(index, query(sample), static_cast<std::int64_t>(crossings_.runs(row).at(sample[0])),
             static_cast<std::int64_t>(cap_crossings_.runs(row).at(sample[0])));
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
  // Whether numbers of turns that are off by less than `needed` are on w's side.
  [[nodiscard]] bool is_certain(double w, double needed) const {
    return distance_to_threshold(side_.rule(), w) - kRounding * std::abs(w) > needed;
  }

  [[nodiscard]] Block block(std::size_t n) const;
  void sort(std::span<const FlatPiece> pieces, std::vector<std::vector<std::uint32_t>>& columns) const;
  void look_at(Block block, std::vector<Candidate>& candidates, std::vector<Block>& parts,
               std::vector<Block>& undecided) const;
  [[nodiscard]] Candidate candidate_of(Block block, const Box& box) const;
  void evaluate_rows(const Block& block) const;
  void evaluate_each(std::span<const Block> blocks) const;
  void evaluate(std::span<Candidate> candidates) const;
  [[nodiscard]] bool decide(const Block& block, bool closed, double rest, double needed) const;
  [[nodiscard]] bool decide(const Candidate& candidate) const;
  [[nodiscard]] std::pair<std::array<std::size_t, 3>, double> middle_of(const Block& block, const Box& box) const;
  [[nodiscard]] std::optional<NodeGrid> grid_of(const Candidate& candidate) const;
  [[nodiscard]] bool choose_nodes(Candidate& candidate) const;
  void interpolate(const Candidate& candidate, std::vector<Block>& undecided) const;
  void interpolate(const Candidate& candidate, const Block& part, double needed, InterpolationScratch& scratch,
                   std::vector<Block>& undecided) const;
  void set_row(const std::array<std::size_t, 3>& first, std::span<const double> rest, bool closed, double needed,
               std::vector<Block>& undecided) const;
  void divide(Block block, std::vector<Block>& parts) const;

  const ScaledMesh& mesh_;
  const LatticeRows& rows_;
  const SideOf side_;
  const LatticeSums& crossings_;
  const LatticeSums& cap_crossings_;
  std::span<std::uint8_t> sides_;
  const ChangeBound& changes_;
  const MatrixKernel matrices_;
  std::atomic<std::size_t> tried_ = 0, in_vain_ = 0;  // samples
  std::array<std::size_t, 3> blocks_;                 // per axis
  std::vector<FlatPiece> cones_;                      // of the rays that meet an edge, one per edge
  struct {
    std::vector<std::vector<std::uint32_t>> caps, edges;  // what projects into a column of blocks along x
  } columns_;
};

Block RuleBlocks::block(std::size_t n) const {
  const std::array<std::size_t, 3> number{n % blocks_[0], n / blocks_[0] % blocks_[1], n / blocks_[0] / blocks_[1]};
  Block block;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    block.first[axis] = number[axis] * kSides[axis];
    block.last[axis] = std::min(block.first[axis] + kSides[axis], coordinates(axis).size());
  }
  const std::size_t column = number[2] * blocks_[1] + number[1];
  block.caps = columns_.caps[column];
  if (!block.caps.empty()) block.edges = columns_.edges[column];
  return block;
}

void RuleBlocks::sort(std::span<const FlatPiece> pieces, std::vector<std::vector<std::uint32_t>>& columns) const {
  // The blocks whose boxes may meet [lower, upper].
  const auto range = [&](std::size_t axis, double lower, double upper) {
    const std::vector<double>& all = coordinates(axis);
    const auto first = static_cast<std::size_t>(std::ranges::lower_bound(all, lower) - all.begin());
    const auto last = static_cast<std::size_t>(std::ranges::upper_bound(all, upper) - all.begin());
    return std::array{(std::max<std::size_t>(first, 1) - 1) / kSides[axis],
                      std::min(last, all.size() - 1) / kSides[axis]};
  };
  columns.resize(blocks_[1] * blocks_[2]);
  for (std::uint32_t number = 0; number < pieces.size(); ++number) {
    const Box& box = pieces[number].box();
    const auto [y_first, y_last] = range(1, box.lower.y, box.upper.y);
    const auto [z_first, z_last] = range(2, box.lower.z, box.upper.z);
    for (std::size_t z = z_first; z <= z_last; ++z) {
      for (std::size_t y = y_first; y <= y_last; ++y) columns[z * blocks_[1] + y].push_back(number);
    }
  }
}

// Makes it a candidate, or divides it, or gives it up.
void RuleBlocks::look_at(Block block, std::vector<Candidate>& candidates, std::vector<Block>& parts,
                         std::vector<Block>& undecided) const {
  if (block.size() <= kFew) {
    undecided.push_back({block.first, block.last});
    return;
  }
  const Box box = box_of(block);
  std::erase_if(block.caps, [&](std::uint32_t piece) { return !changes_.wide_caps()[piece].may_meet(box); });
  if (block.caps.empty()) block.edges.clear();
  std::erase_if(block.edges, [&](std::uint32_t edge) { return !cones_[edge].may_meet(box); });
  if (!block.is_cut()) {
    Candidate candidate = candidate_of(std::move(block), box);
    if (candidate.change <= kMostChange) {
      candidates.push_back(std::move(candidate));
      return;
    }
    block = std::move(candidate.block);
  }
  if (block.size() <= 2 * kFew) return undecided.push_back({block.first, block.last});  // its parts would be few
  divide(std::move(block), parts);
}

Candidate RuleBlocks::candidate_of(Block block, const Box& box) const {
  Candidate candidate{std::move(block), false, 0.0, 0.0, {}, {{}}, {}};
  candidate.closed = candidate.block.caps.empty();
  const auto [middle, radius] = middle_of(candidate.block, box);
  candidate.samples.front() = middle;
  candidate.gradient = changes_.gradient_in(box, kMostChange / radius);
  candidate.change = radius * candidate.gradient * (1 + kRounding);
  return candidate;
}

void RuleBlocks::evaluate(std::span<Candidate> candidates) const {
  struct Place {
    Candidate* candidate;
    std::size_t sample;
  };
  std::vector<Place> places;
  for (Candidate& candidate : candidates) {
    candidate.rest.resize(candidate.samples.size());
    for (std::size_t n = 0; n < candidate.samples.size(); ++n) places.push_back({&candidate, n});
  }
  auto set = [&](std::size_t index, const Vec3&, double w) {
    const auto [candidate, n] = places[index];
    candidate->rest[n] = w - crossings_at(candidate->samples[n], candidate->closed);
  };
  using Tile = LatticeTile<decltype(set)>;
  Tile tile(mesh_, set, Tile::Sum::kUnsettled);
  for (std::size_t index = 0; index < places.size(); ++index) {
    const std::array<std::size_t, 3>& sample = places[index].candidate->samples[places[index].sample];
    add(tile, index, sample);
  }
  tile.evaluate();
}

// Sets the sides of the block's samples if they are certain, the rest being off by at most `needed`.
bool RuleBlocks::decide(const Block& block, bool closed, double rest, double needed) const {
  return for_each_run(block, closed, [&](std::size_t begin, std::size_t end, double n) {
    const double w = n + rest;
    if (!is_certain(w, needed)) return false;
    std::fill(sides_.begin() + static_cast<std::ptrdiff_t>(begin), sides_.begin() + static_cast<std::ptrdiff_t>(end),
              holds(side_.rule(), w) ? 1 : 0);
    return true;
  });
}

bool RuleBlocks::decide(const Candidate& candidate) const {
  const double rest = candidate.rest[0];
  return decide(candidate.block, candidate.closed, rest,
                candidate.change + mesh_.doubt() + kRounding * (1 + std::abs(rest)));
}

// The sample in the middle, and how far others are from it at most.
std::pair<std::array<std::size_t, 3>, double> RuleBlocks::middle_of(const Block& block, const Box& box) const {
  std::array<std::size_t, 3> middle;
  double to_farthest = 0.0;  // its square
  for (std::size_t axis = 0; axis < 3; ++axis) {
    middle[axis] = block.first[axis] + block.count(axis) / 2;
    const double x = coordinates(axis)[middle[axis]];
    const double extent = std::max(x - box.lower[static_cast<int>(axis)], box.upper[static_cast<int>(axis)] - x);
    to_farthest += extent * extent;
  }
  return {middle, std::sqrt(to_farthest)};
}

// The nodes for which they and the samples that are left undecided are fewest together, about. None where there are
// none that are within kMostBend.
std::optional<NodeGrid> RuleBlocks::grid_of(const Candidate& candidate) const {
  const Block& block = candidate.block;
  const Box box = box_of(block);
  const ChangeSums derivatives = changes_.derivatives_in(box);
  const auto samples = static_cast<double>(block.size());
  // Of an axis, with nodes at Chebyshev's points; samples are next to them.
  const auto error = [&](std::size_t axis, std::size_t degree) {
    constexpr double kNextTo = 1.5;
    if (degree + 1 >= block.count(axis)) return 0.0;
    const double quarter = (box.upper[static_cast<int>(axis)] - box.lower[static_cast<int>(axis)]) / 4;
    return 2 * kNextTo * std::pow(quarter, static_cast<double>(degree + 1)) * derivatives[degree];
  };
  std::array<std::size_t, 3> degrees{}, best{};
  double least = std::numeric_limits<double>::infinity();
  for (double bend = kMostBend; bend > 1e-5; bend /= 2) {
    double nodes = 1.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      while (degrees[axis] + 1 < derivatives.size() && error(axis, degrees[axis]) > bend / 4) ++degrees[axis];
      if (error(axis, degrees[axis]) > bend / 4) nodes = std::numeric_limits<double>::infinity();
      nodes *= static_cast<double>(degrees[axis] + 1);
    }
    const double cost = nodes + std::min(kUndecided * bend / candidate.change, 1.0) * samples;
    if (cost < least) least = cost, best = degrees;
    if (nodes > least) break;
  }
  if (!(least < samples)) return std::nullopt;
  NodeGrid grid;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::span<const double> all(coordinates(axis));
    const AxisNodes& along = grid.along.emplace_back(all.subspan(block.first[axis], block.count(axis)), best[axis]);
    grid.bend = along.error(derivatives[along.degree()]) + along.growth() * grid.bend;
    grid.growth *= along.growth();
  }
  grid.bend *= 1 + kRounding;
  if (!(grid.bend <= kMostBend)) return std::nullopt;
  return grid;
}

// Makes the nodes that leave fewest samples to evaluate the candidate's samples. Returns whether that is worth it.
bool RuleBlocks::choose_nodes(Candidate& candidate) const {
  std::optional<NodeGrid> grid = grid_of(candidate);
  if (!grid) return false;
  const Block& block = candidate.block;
  const auto samples = static_cast<double>(block.size());
  const double cost = static_cast<double>(grid->size(0) * grid->size(1) * grid->size(2)) +
                      (kInterpolation + std::min(kUndecided * grid->bend / candidate.change, 1.0)) * samples;
  if (!(cost < samples) || (block.size() > kSmall && cost > kWorthIt * samples)) return false;
  candidate.samples.clear();
  for (const std::size_t k : grid->along[2].nodes()) {
    for (const std::size_t j : grid->along[1].nodes()) {
      for (const std::size_t i : grid->along[0].nodes()) {
        candidate.samples.push_back({block.first[0] + i, block.first[1] + j, block.first[2] + k});
      }
    }
  }
  candidate.nodes = std::move(*grid);
  return true;
}

// Sets the sides that are certain by interpolation between the nodes. Adds the other samples, in runs.
void RuleBlocks::interpolate(const Candidate& candidate, std::vector<Block>& undecided) const {
  constexpr std::array<std::size_t, 3> kPart{24, 12, 12};  // samples
  const Block& block = candidate.block;
  double largest = 0.0;
  for (const double rest : candidate.rest) largest = std::max(largest, std::abs(rest));
  const double doubt = mesh_.doubt() + 32 * kRounding * (1 + largest);
  const double needed = candidate.nodes.bend + candidate.nodes.growth * doubt;
  InterpolationScratch scratch;
  Block part;
  for (std::size_t k = block.first[2]; k < block.last[2]; k = part.last[2]) {
    for (std::size_t j = block.first[1]; j < block.last[1]; j = part.last[1]) {
      for (std::size_t i = block.first[0]; i < block.last[0]; i = part.last[0]) {
        part.first = {i, j, k};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          part.last[axis] = std::min(part.first[axis] + kPart[axis], block.last[axis]);
        }
        interpolate(candidate, part, needed, scratch, undecided);
      }
    }
  }
}

// Of a part of the candidate's block: from the sample in its middle alone, where the part is decided by that.
void RuleBlocks::interpolate(const Candidate& candidate, const Block& part, double needed,
                             InterpolationScratch& scratch, std::vector<Block>& undecided) const {
  const NodeGrid& grid = candidate.nodes;
  const AxisNodes &x = grid.along[0], &y = grid.along[1], &z = grid.along[2];
  const auto at = [&](std::size_t axis, std::size_t sample) { return sample - candidate.block.first[axis]; };
  const auto [middle, radius] = middle_of(part, box_of(part));
  const double rest = grid.at(candidate.rest, {at(0, middle[0]), at(1, middle[1]), at(2, middle[2])});
  if (decide(part, candidate.closed, rest, needed + radius * candidate.gradient * (1 + kRounding))) return;
  const std::size_t nx = grid.size(0), ny = grid.size(1), rows = part.count(1), width = (part.count(0) + 7) / 8 * 8;
  auto& [layer, nodes, values] = scratch;  // the nodes along x and y of a layer; those along x of its rows; its rows
  nodes.resize(rows * nx);
  values.resize(rows * width);
  for (std::size_t k = part.first[2]; k < part.last[2]; ++k) {
    layer.assign(ny * nx, 0.0);
    for (std::size_t n = 0; n < grid.size(2); ++n) {
      const double weight = z.weights(n)[at(2, k)];
      for (std::size_t i = 0; i < layer.size(); ++i) layer[i] += weight * candidate.rest[n * layer.size() + i];
    }
    std::ranges::fill(nodes, 0.0);
    for (std::size_t n = 0; n < ny; ++n) {
      for (std::size_t j = 0; j < rows; ++j) {
        const double weight = y.weights(n)[at(1, part.first[1]) + j];
        for (std::size_t i = 0; i < nx; ++i) nodes[j * nx + i] += weight * layer[n * nx + i];
      }
    }
    matrices_.multiply({nodes.data(), nx, 1}, {x.weights(0).data() + at(0, part.first[0]), x.row_size()},
                       {values.data(), width}, rows, nx, width);
    for (std::size_t j = 0; j < rows; ++j) {
      set_row({part.first[0], part.first[1] + j, k}, std::span(values).subspan(j * width, part.count(0)),
              candidate.closed, needed, undecided);
    }
  }
}

// Of samples of a row, from the first one on; some at a time, where all of them are on the same side.
void RuleBlocks::set_row(const std::array<std::size_t, 3>& first, std::span<const double> rest, bool closed,
                         double needed, std::vector<Block>& undecided) const {
  constexpr std::size_t kTogether = 16;
  const std::size_t x = first[0], j = first[1], k = first[2];
  const std::size_t row = row_of(j, k) * rows_.xs.size();
  const Block part{{x, j, k}, {x + rest.size(), j + 1, k + 1}};
  for_each_run(part, closed, [&](std::size_t begin, std::size_t end, double n) {
    for (std::size_t some = begin - row; some < end - row; some += kTogether) {
      const std::size_t last = std::min(some + kTogether, end - row);
      const auto values = rest.subspan(some - x, last - some);
      double least = values[0], most = values[0];
      for (const double value : values) least = std::min(least, value), most = std::max(most, value);
      const double middle = n + (least + most) / 2;
      if (is_certain(middle, needed + (most - least) / 2 + kRounding * (1 + std::abs(least) + std::abs(most)))) {
        std::fill_n(sides_.begin() + static_cast<std::ptrdiff_t>(row + some), last - some, holds(side_.rule(), middle));
        continue;
      }
      for (std::size_t i = some; i < last; ++i) {
        const double w = n + rest[i - x];
        if (is_certain(w, needed)) {
          sides_[row + i] = holds(side_.rule(), w) ? 1 : 0;
        } else if (i > begin - row && !undecided.empty() && undecided.back().last == std::array{i, j + 1, k + 1}) {
          ++undecided.back().last[0];  // of the same run
        } else {
          undecided.push_back({{i, j, k}, {i + 1, j + 1, k + 1}});
        }
      }
    }
    return true;
  });
}

// All of its samples. Those that share a ray are cheaper together.
void RuleBlocks::evaluate_rows(const Block& block) const {
  RowTiles tiles(mesh_, [this](std::size_t index, const Vec3& q, double w) { sides_[index] = side_(q, w); });
  for (std::size_t k = block.first[2]; k < block.last[2]; ++k) {
    for (std::size_t j = block.first[1]; j < block.last[1]; ++j) {
      const std::size_t row = row_of(j, k);
      tiles.begin_row(block.count(0));
      crossings_.runs(row).for_each(
          block.first[0], block.last[0], [&](std::size_t begin, std::size_t end, double crossed) {
            for (std::size_t i = begin; i < end; ++i) {
              tiles.add(row * rows_.xs.size() + i, query({i, j, k}), static_cast<std::int64_t>(crossed));
            }
            return true;
          });
    }
  }
  tiles.finish();
}

// Neighbours in space together: the far field then takes much the same way for them.
void RuleBlocks::evaluate_each(std::span<const Block> blocks) const {
  struct Place {
    std::uint64_t code;
    std::array<std::size_t, 3> sample;
  };
  std::vector<Place> places;
  for (const Block& block : blocks) {
    for (std::size_t k = block.first[2]; k < block.last[2]; ++k) {
      for (std::size_t j = block.first[1]; j < block.last[1]; ++j) {
        for (std::size_t i = block.first[0]; i < block.last[0]; ++i) {
          places.push_back({code_of({i, j, k}), {i, j, k}});
        }
      }
    }
  }
  std::ranges::sort(places, {}, &Place::code);
  LatticeTile tile(mesh_, [this](std::size_t index, const Vec3& q, double w) { sides_[index] = side_(q, w); });
  for (const Place& place : places) {
    const auto& [i, j, k] = place.sample;
    add(tile, row_of(j, k) * rows_.xs.size() + i, place.sample);
  }
  tile.evaluate();
}

// Into rows at last where caps and cones come in, else along all of its longer sides.
void RuleBlocks::divide(Block block, std::vector<Block>& parts) const {
  const Box box = box_of(block);
  const Vec3 size = box.upper - box.lower;
  const bool across = block.is_cut() && block.count(0) <= kRow;
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
  // In rounds, each of which knows all of those before it, so that the work is the same for any number of threads.
  constexpr std::size_t kFirstRound = 8;
  for (std::size_t first = 0, last = kFirstRound; first < blocks.blocks(); first = last, last *= 2) {
    const bool by_certificates = blocks.are_worth_it();
    parallel_for(std::min(last, blocks.blocks()) - first, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        const std::size_t samples = blocks.apply(first + n, by_certificates);
        if (done) done->fetch_add(samples, std::memory_order_relaxed);
      }
    });
  }
}

}  // namespace raycone
