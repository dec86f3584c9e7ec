#include "core/evaluation/node_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace raycone {
namespace {

// Of interpolation between nodes: how much it may be off, turns, and what it leaves undecided of a block, relative to
// how much of the change in the block that is (measured). Nodes and samples that are left are counted alike; this share
// of the samples takes as long as interpolation of all.
constexpr double kMostBend = 0.04;
constexpr double kUndecided = 1.0;
constexpr double kInterpolation = 1.0 / 100;
// Larger blocks than this are divided, unless interpolation takes so little, of each.
constexpr std::size_t kSmall = 1024;
constexpr double kWorthIt = 1.0 / 16;

// What is left undecided where interpolation is off by `bend`.
double undecided(double bend, double change, double samples) {
  return std::min(kUndecided * bend / change, 1.0) * samples;
}

using Degrees = std::array<std::size_t, 3>;

// Those of least cost, for nodes at Chebyshev's points; samples are next to them.
std::optional<Degrees> choose_degrees(const LatticeRows& rows, const SampleBox& box,
                                      std::span<const double> derivatives, double change) {
  constexpr double kNextTo = 1.5;
  const Box space = rows.box_of(box);
  const auto samples = static_cast<double>(box.size());
  const auto error = [&](std::size_t axis, std::size_t degree) {
    if (degree + 1 >= box.side(axis)) return 0.0;
    const double quarter = (space.upper[static_cast<int>(axis)] - space.lower[static_cast<int>(axis)]) / 4;
    return 2 * kNextTo * std::pow(quarter, static_cast<double>(degree + 1)) * derivatives[degree];
  };
  Degrees degrees{}, best{};
  double least = std::numeric_limits<double>::infinity();
  for (double bend = kMostBend; bend > 1e-5; bend /= 2) {
    double nodes = 1.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      while (degrees[axis] + 1 < derivatives.size() && error(axis, degrees[axis]) > bend / 4) ++degrees[axis];
      if (error(axis, degrees[axis]) > bend / 4) nodes = std::numeric_limits<double>::infinity();
      nodes *= static_cast<double>(degrees[axis] + 1);
    }
    const double cost = nodes + undecided(bend, change, samples);
    if (cost < least) {
      least = cost;
      best = degrees;
    }
    if (nodes > least) break;
  }
  if (!(least < samples)) return std::nullopt;
  return best;
}

}  // namespace

std::optional<NodeGrid> choose_nodes(const LatticeRows& rows, const SampleBox& box, std::span<const double> derivatives,
                                     double change) {
  const std::optional<Degrees> degrees = choose_degrees(rows, box, derivatives, change);
  if (!degrees) return std::nullopt;
  NodeGrid grid(rows, box, *degrees, derivatives);
  if (!(grid.bend() <= kMostBend)) return std::nullopt;
  const auto samples = static_cast<double>(box.size());
  const double cost =
      static_cast<double>(grid.size()) + kInterpolation * samples + undecided(grid.bend(), change, samples);
  if (!(cost < samples) || (box.size() > kSmall && cost > kWorthIt * samples)) return std::nullopt;
  return grid;
}

}  // namespace raycone
