#include "core/evaluation/rule_blocks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <numbers>
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
constexpr std::size_t kHopeless = 8 * kFew;  // where certificates failed: parts are as few as that
constexpr double kMostChange = 0.5;  // turns, from a sample: more is hardly ever below the distance from a threshold

// Of interpolation between nodes: the largest blocks, by how much it may be off, turns, and how many steps there are
// between nodes along the longest side at most. It leaves the more samples undecided the longer steps are, this share
// of all per turn that it may be off (measured); of shorter ones, nodes are too many.
constexpr std::size_t kInterpolated = 8192;
constexpr double kMostBend = 0.04;
constexpr std::size_t kMostSteps = 6;
constexpr double kUndecided = 10.0;
// Larger blocks than this are divided, unless interpolation leaves so few samples to evaluate, of each.
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

// Samples that a grid of nodes consists of: their numbers along each axis, the first and the last of a block included.
// Interpolation along an axis is linear between two nodes, or quadratic between three, of which every second is shared.
struct NodeGrid {
  std::array<std::vector<std::size_t>, 3> along;
  std::array<bool, 3> is_quadratic{};
  double bend = 0.0;    // turns by which samples are at most off what is interpolated between nodes
  double growth = 1.0;  // of what values at nodes are off by

  [[nodiscard]] std::size_t size() const { return along[0].size() * along[1].size() * along[2].size(); }
  [[nodiscard]] std::size_t index(const std::array<std::size_t, 3>& node) const {
    return (node[2] * along[1].size() + node[1]) * along[0].size() + node[0];
  }
};

// Of a sample along one axis: the first of the nodes around it, and how much each of them counts.
struct PlaceInGrid {
  std::size_t node;
  std::array<double, 3> weights;

  // value(node) of the nodes that count.
  template <class Value>
  [[nodiscard]] double between(const Value& value) const {
    double sum = 0.0;
    for (std::size_t n = 0; n < weights.size(); ++n) {
      if (weights[n] != 0.0) sum += weights[n] * value(node + n);
    }
    return sum;
  }
};

// What interpolation along one axis is off by, turns, and how much it makes of what values at nodes are off by.
struct AxisError {
  double bend, growth;
};

// Of a function whose second derivatives are at most `second`, between two nodes of this distance.
AxisError linear_error(double step, double second) { return {step * step / 8 * second, 1.0}; }

// Of one whose third derivatives are at most `third`, between three nodes of these distances. The error is a sixth of
// the derivative times (x - a)(x - b)(x - c), which grows with either distance; of equal ones it is known.
AxisError quadratic_error(double step, double next, double third) {
  const double longer = std::max(step, next), shorter = std::min(step, next);
  const double product = 2 / (3 * std::numbers::sqrt3) * longer * longer * longer;
  return {product / 6 * third, 1 + longer * longer / (2 * (longer + shorter) * shorter)};
}

// A block in which the rest is smooth: w less the crossings of the closed mesh where no cap comes in or, where no cone
// does (a row passes through none), less those of the mesh. It is known well enough once it is known at one sample, or
// at some nodes.
struct Candidate {
  Block block;
  bool closed;
  double change;  // from the sample in the middle to others at most, turns
  ChangeBound::Bounds bounds;
  NodeGrid nodes;
  std::vector<std::array<std::size_t, 3>> samples;  // one in the middle, or the nodes
  std::vector<double> rest;                         // at each of them
};

bool overlap(const Box& a, const Box& b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!(a.lower[axis] <= b.upper[axis] && b.lower[axis] <= a.upper[axis])) return false;
  }
  return true;
}

// Of all points from which a ray meets the edge.
Box cone_of(const DirectedEdge& edge) {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = std::min(edge.from[axis], edge.to[axis]);
    box.upper[axis] = std::max(edge.from[axis], edge.to[axis]);
  }
  box.lower.x = -std::numeric_limits<double>::infinity();
  return box;
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
    const std::span<const Box> caps = changes_.wide_caps();
    sort(caps, columns_.caps);
    for (const DirectedEdge& edge : mesh.boundary().directed_edges()) cones_.push_back(cone_of(edge));
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
  // Whether numbers of turns that are off by less than `needed` are on w's side.
  [[nodiscard]] bool is_certain(double w, double needed) const {
    return distance_to_threshold(side_.rule(), w) - kRounding * std::abs(w) > needed;
  }

  [[nodiscard]] Block block(std::size_t n) const;
  void sort(std::span<const Box> boxes, std::vector<std::vector<std::uint32_t>>& columns) const;
  void look_at(Block block, std::vector<Candidate>& candidates, std::vector<Block>& parts,
               std::vector<Block>& undecided) const;
  [[nodiscard]] Candidate candidate_of(Block block, const Box& box) const;
  void evaluate_each(const Block& whole, std::span<const Block> blocks) const;
  void evaluate(std::span<Candidate> candidates) const;
  [[nodiscard]] bool decide(const Candidate& candidate) const;
  [[nodiscard]] NodeGrid grid_of(const Candidate& candidate, std::size_t steps) const;
  [[nodiscard]] AxisError choose_order(NodeGrid& grid, std::size_t axis, const ChangeBound::Bounds& bounds) const;
  [[nodiscard]] bool choose_nodes(Candidate& candidate) const;
  void interpolate(const Candidate& candidate, std::vector<Block>& undecided) const;
  [[nodiscard]] std::vector<PlaceInGrid> places_along(const Block& block, const NodeGrid& grid, std::size_t axis) const;
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
  std::vector<Box> cones_;                            // of the rays that meet an edge, one per edge
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

void RuleBlocks::sort(std::span<const Box> boxes, std::vector<std::vector<std::uint32_t>>& columns) const {
  // The blocks whose boxes may meet [lower, upper].
  const auto range = [&](std::size_t axis, double lower, double upper) {
    const std::vector<double>& all = coordinates(axis);
    const auto first = static_cast<std::size_t>(std::ranges::lower_bound(all, lower) - all.begin());
    const auto last = static_cast<std::size_t>(std::ranges::upper_bound(all, upper) - all.begin());
    return std::array{(std::max<std::size_t>(first, 1) - 1) / kSides[axis],
                      std::min(last, all.size() - 1) / kSides[axis]};
  };
  columns.resize(blocks_[1] * blocks_[2]);
  for (std::uint32_t number = 0; number < boxes.size(); ++number) {
    const Box& box = boxes[number];
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
  std::erase_if(block.caps, [&](std::uint32_t piece) { return !overlap(box, changes_.wide_caps()[piece]); });
  if (block.caps.empty()) block.edges.clear();
  std::erase_if(block.edges, [&](std::uint32_t edge) { return !overlap(box, cones_[edge]); });
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
  Candidate candidate{std::move(block), false, 0.0, {}, {}, {{}}, {}};
  candidate.closed = candidate.block.caps.empty();
  double to_farthest = 0.0;  // its square
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double lower = box.lower[static_cast<int>(axis)], upper = box.upper[static_cast<int>(axis)];
    std::size_t& middle = candidate.samples.front()[axis];
    middle = candidate.block.first[axis] + candidate.block.count(axis) / 2;
    const double x = coordinates(axis)[middle], extent = std::max(x - lower, upper - x);
    to_farthest += extent * extent;
  }
  const double radius = std::sqrt(to_farthest);
  candidate.bounds = changes_.in(box, kMostChange / radius);
  candidate.change = radius * candidate.bounds.gradient * (1 + kRounding);
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

// So many steps between nodes along the longest side, fewer along others. What is off along one axis is interpolated
// along the next.
NodeGrid RuleBlocks::grid_of(const Candidate& candidate, std::size_t steps) const {
  const Block& block = candidate.block;
  const Vec3 size = box_of(block).upper - box_of(block).lower;
  const double longest = std::max({size.x, size.y, size.z});
  NodeGrid grid;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t most = block.count(axis) - 1;
    const double share = longest > 0.0 ? size[static_cast<int>(axis)] / longest : 0.0;
    const auto wanted = static_cast<std::size_t>(std::lround(share * static_cast<double>(steps)));
    const std::size_t parts = std::clamp<std::size_t>(wanted, 1, std::max<std::size_t>(most, 1));
    for (std::size_t n = 0; n <= parts && (n == 0 || most > 0); ++n) {
      grid.along[axis].push_back(block.first[axis] + n * most / parts);
    }
    const AxisError error = choose_order(grid, axis, candidate.bounds);
    grid.bend = error.bend + error.growth * grid.bend;
    grid.growth *= error.growth;
  }
  grid.bend *= 1 + kRounding;
  return grid;
}

// Of the order that is less off.
AxisError RuleBlocks::choose_order(NodeGrid& grid, std::size_t axis, const ChangeBound::Bounds& bounds) const {
  const std::vector<std::size_t>& nodes = grid.along[axis];
  const auto step = [&](std::size_t n) { return coordinates(axis)[nodes[n + 1]] - coordinates(axis)[nodes[n]]; };
  AxisError linear{0.0, 1.0}, quadratic{0.0, 1.0};
  for (std::size_t n = 0; n + 1 < nodes.size(); ++n) {
    if (nodes[n + 1] - nodes[n] > 1) linear.bend = std::max(linear.bend, linear_error(step(n), bounds.second).bend);
  }
  if (nodes.size() % 2 == 0 || linear.bend == 0.0) return linear;
  for (std::size_t n = 0; n + 2 < nodes.size(); n += 2) {
    const AxisError here = quadratic_error(step(n), step(n + 1), bounds.third);
    quadratic = {std::max(quadratic.bend, here.bend), std::max(quadratic.growth, here.growth)};
  }
  grid.is_quadratic[axis] = quadratic.bend < linear.bend;
  return grid.is_quadratic[axis] ? quadratic : linear;
}

// Makes the nodes that leave fewest samples to evaluate the candidate's samples. Returns whether that is worth it.
bool RuleBlocks::choose_nodes(Candidate& candidate) const {
  const std::size_t size = candidate.block.size();
  if (size > kInterpolated) return false;
  const auto samples = static_cast<double>(size);
  double least = samples;
  for (std::size_t steps = 1; steps <= kMostSteps; ++steps) {
    NodeGrid grid = grid_of(candidate, steps);
    const double cost = static_cast<double>(grid.size()) + std::min(kUndecided * grid.bend, 1.0) * samples;
    if (steps > 1 && !(cost < least)) continue;
    least = cost;
    candidate.nodes = std::move(grid);
  }
  if (!(candidate.nodes.bend <= kMostBend) || !(least < samples) || (size > kSmall && least > kWorthIt * samples))
    return false;
  const auto& [xs, ys, zs] = candidate.nodes.along;
  candidate.samples.clear();
  for (const std::size_t k : zs) {
    for (const std::size_t j : ys) {
      for (const std::size_t i : xs) candidate.samples.push_back({i, j, k});
    }
  }
  return true;
}

// Sets the sides that are certain by interpolation between the nodes. Adds the other samples, in runs.
void RuleBlocks::interpolate(const Candidate& candidate, std::vector<Block>& undecided) const {
  const Block& block = candidate.block;
  const NodeGrid& grid = candidate.nodes;
  double largest = 0.0;
  for (const double rest : candidate.rest) largest = std::max(largest, std::abs(rest));
  const double needed = grid.bend + grid.growth * (mesh_.doubt() + 32 * kRounding * (1 + largest));
  const std::array<std::vector<PlaceInGrid>, 3> places{places_along(block, grid, 0), places_along(block, grid, 1),
                                                       places_along(block, grid, 2)};
  std::vector<double> nodes(grid.along[0].size()), rest(block.count(0));  // along a row
  for (std::size_t k = block.first[2]; k < block.last[2]; ++k) {
    for (std::size_t j = block.first[1]; j < block.last[1]; ++j) {
      const PlaceInGrid &y = places[1][j - block.first[1]], &z = places[2][k - block.first[2]];
      for (std::size_t n = 0; n < nodes.size(); ++n) {
        nodes[n] = z.between([&](std::size_t of_z) {
          return y.between([&](std::size_t of_y) { return candidate.rest[grid.index({n, of_y, of_z})]; });
        });
      }
      for (std::size_t i = 0; i < rest.size(); ++i) {
        rest[i] = places[0][i].between([&](std::size_t n) { return nodes[n]; });
      }
      const std::size_t row = row_of(j, k) * rows_.xs.size();
      const Block part{{block.first[0], j, k}, {block.last[0], j + 1, k + 1}};
      for_each_run(part, candidate.closed, [&](std::size_t begin, std::size_t end, double n) {
        for (std::size_t i = begin - row; i < end - row; ++i) {
          const double w = n + rest[i - block.first[0]];
          if (is_certain(w, needed)) {
            sides_[row + i] = holds(side_.rule(), w) ? 1 : 0;
          } else if (i > begin - row && !undecided.empty() && undecided.back().last == std::array{i, j + 1, k + 1}) {
            ++undecided.back().last[0];  // of the same run
          } else {
            undecided.push_back({{i, j, k}, {i + 1, j + 1, k + 1}});
          }
        }
        return true;
      });
    }
  }
}

// Of each of the block's samples along an axis.
std::vector<PlaceInGrid> RuleBlocks::places_along(const Block& block, const NodeGrid& grid, std::size_t axis) const {
  const std::vector<std::size_t>& nodes = grid.along[axis];
  const std::vector<double>& all = coordinates(axis);
  const std::size_t order = grid.is_quadratic[axis] ? 2 : 1;
  std::vector<PlaceInGrid> places;
  for (std::size_t i = block.first[axis], node = 0; i < block.last[axis]; ++i) {
    while (node + order + 1 < nodes.size() && nodes[node + order] <= i) node += order;
    PlaceInGrid& place = places.emplace_back(PlaceInGrid{node, {1.0, 0.0, 0.0}});
    if (nodes.size() == 1) continue;
    for (std::size_t n = 0; n <= order; ++n) {  // Lagrange
      place.weights[n] = 1.0;
      const double x = all[nodes[node + n]];
      for (std::size_t other = 0; other <= order; ++other) {
        const double from = all[nodes[node + other]];
        if (other != n) place.weights[n] *= (all[i] - from) / (x - from);
      }
    }
  }
  return places;
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
