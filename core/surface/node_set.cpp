#include "core/surface/node_set.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <span>

#include "core/machine/threads.h"

namespace raycone {
namespace {

constexpr std::int64_t kSlabNodes = std::int64_t{1} << 22;

LatticeBlock slab_of_nodes(const Lattice& lattice, std::int64_t first_layer) {
  const std::int64_t layers = std::max<std::int64_t>(1, kSlabNodes / (lattice.counts[0] * lattice.counts[1]));
  LatticeBlock slab = whole(lattice);
  slab.first[2] += first_layer;
  slab.counts[2] = std::min(layers, lattice.counts[2] - first_layer);
  return slab;
}

// Values that are so near to a threshold that the rule could be wrong.
void settle_values(const WindingNumberEvaluator& evaluator, const Rule& rule, const Lattice& lattice,
                   const LatticeBlock& slab, std::span<double> values) {
  const std::vector<double> thresholds = thresholds_to_settle(rule);
  const double doubt = evaluator.doubt();
  if (thresholds.empty() || doubt == 0.0) return;
  parallel_for(values.size(), std::size_t{1} << 10, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const auto number = static_cast<std::int64_t>(n), row = number / slab.counts[0];
      for (const double threshold : thresholds) {
        if (std::abs(values[n] - threshold) > doubt) continue;
        const Vec3 point{lattice.coordinate(0, slab.first[0] + number % slab.counts[0]),
                         lattice.coordinate(1, slab.first[1] + row % slab.counts[1]),
                         lattice.coordinate(2, slab.first[2] + row / slab.counts[1])};
        values[n] = evaluator.settle(point, values[n], threshold);
      }
    }
  });
}

}  // namespace

NodeSet::NodeSet(const Lattice& lattice)
    : lattice_(lattice),
      words_per_row_((lattice.counts[0] + 63) / 64),
      words_(static_cast<std::size_t>(words_per_row_ * lattice.counts[1] * lattice.counts[2]), 0) {}

bool NodeSet::empty() const {
  return std::ranges::all_of(words_, [](std::uint64_t word) { return word == 0; });
}

std::uint64_t NodeSet::size() const {
  return std::accumulate(words_.begin(), words_.end(), std::uint64_t{0}, [](std::uint64_t sum, std::uint64_t word) {
    return sum + static_cast<std::uint64_t>(std::popcount(word));
  });
}

void NodeSet::flip(const NodeSet& others) {
  for (std::size_t n = 0; n < words_.size(); ++n) words_[n] ^= others.words_[n];
}

bool NodeSet::reaches_border() const {
  for (std::int64_t k = 0; k < count(2); ++k) {
    for (std::int64_t j = 0; j < count(1); ++j) {
      const bool outermost = k == 0 || k == count(2) - 1 || j == 0 || j == count(1) - 1;
      const std::uint64_t* const bits = row(j, k);
      if (outermost ? std::any_of(bits, bits + words_per_row_, [](std::uint64_t word) { return word != 0; })
                    : holds(0, j, k) || holds(count(0) - 1, j, k))
        return true;
    }
  }
  return false;
}

NodeSet nodes_inside(const WindingNumberEvaluator& evaluator, const Rule& rule, const Lattice& lattice,
                     std::atomic<std::uint64_t>* done) {
  NodeSet nodes(lattice);
  std::vector<double> values;
  for (std::int64_t layer = 0; layer < lattice.counts[2];) {
    const LatticeBlock slab = slab_of_nodes(lattice, layer);
    values.resize(static_cast<std::size_t>(slab.size()));
    evaluator.evaluate_for(rule, lattice, slab, values, done);
    settle_values(evaluator, rule, lattice, slab, values);
    const auto rows = static_cast<std::size_t>(slab.counts[1] * slab.counts[2]);
    parallel_for(rows, 64, [&](std::size_t begin, std::size_t end) {
      for (auto row = static_cast<std::int64_t>(begin); row < static_cast<std::int64_t>(end); ++row) {
        for (std::int64_t i = 0; i < slab.counts[0]; ++i) {
          if (!holds(rule, values[static_cast<std::size_t>(row * slab.counts[0] + i)])) continue;
          nodes.insert(i, row % slab.counts[1], layer + row / slab.counts[1]);
        }
      }
    });
    layer += slab.counts[2];
  }
  return nodes;
}

double node_set_bytes(const Lattice& lattice) {
  const double layer = static_cast<double>(lattice.counts[0]) * static_cast<double>(lattice.counts[1]);
  const double layers = static_cast<double>(lattice.counts[2]);
  const double bits = (layer + 64.0 * static_cast<double>(lattice.counts[1])) * layers / 8.0;
  const double of_slab = std::max(layer, std::min(layer * layers, static_cast<double>(kSlabNodes)));
  constexpr double kPerValue = 12.0;  // the value, and what finding it takes
  return bits + kPerValue * of_slab;
}

}  // namespace raycone
