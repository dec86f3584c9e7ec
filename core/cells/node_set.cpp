#include "core/cells/node_set.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <numeric>
#include <span>

#include "core/data/lattice_slabs.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

constexpr std::int64_t kSlabNodes = std::int64_t{1} << 22;

// Eight bytes that are 0 or 1, as bits. The product brings that of byte n to bit 56 + n. No two bits come to one place,
// so nothing is carried.
std::uint64_t eight_bits(const std::uint8_t* bytes) {
  constexpr std::uint64_t kFromLow = 0x0102'0408'1020'4080, kFromHigh = 0x8040'2010'0804'0201;
  std::uint64_t word = 0;
  std::memcpy(&word, bytes, sizeof word);
  return word * (std::endian::native == std::endian::little ? kFromLow : kFromHigh) >> 56U;
}

// Of 64 of them. Most are alike.
std::uint64_t word_of(const std::uint8_t* bytes) {
  constexpr std::uint64_t kOnes = 0x0101'0101'0101'0101;
  std::array<std::uint64_t, 8> words;
  std::memcpy(words.data(), bytes, sizeof words);
  std::uint64_t any = 0, all = kOnes;
  for (const std::uint64_t eight : words) {
    any |= eight;
    all &= eight;
  }
  if (any == 0) return 0;
  if (all == kOnes) return ~std::uint64_t{0};
  std::uint64_t word = 0;
  for (unsigned n = 0; n < 64; n += 8) word |= eight_bits(bytes + n) << n;
  return word;
}

}  // namespace

NodeSet::NodeSet(const Lattice& lattice)
    : lattice_(lattice),
      words_per_row_((lattice.counts[0] + 63) / 64),
      words_(static_cast<std::size_t>(words_per_row_ * lattice.counts[1] * lattice.counts[2]), 0) {}

NodeSet NodeSet::on(const Lattice& lattice) const {
  NodeSet nodes = *this;
  nodes.lattice_ = lattice;
  return nodes;
}

void NodeSet::set_row(std::int64_t j, std::int64_t k, std::span<const std::uint8_t> holds) {
  std::uint64_t* words = words_.data() + (k * count(1) + j) * words_per_row_;
  for (; holds.size() >= 64; holds = holds.subspan(64)) *words++ = word_of(holds.data());
  for (std::size_t n = 0; n < holds.size(); ++n) {
    if (n == 0) *words = 0;
    *words |= std::uint64_t{holds[n]} << n;
  }
}

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
                     std::atomic<std::uint64_t>* done, Tally* tally) {
  return nodes_inside_of(whole(lattice), evaluator, rule, lattice, done, tally);
}

NodeSet nodes_inside_of(const LatticeBlock& block, const WindingNumberEvaluator& evaluator, const Rule& rule,
                        const Lattice& lattice, std::atomic<std::uint64_t>* done, Tally* tally) {
  NodeSet nodes(lattice);
  std::vector<std::uint8_t> sides;
  for_each_slab(block, kSlabNodes, [&](const LatticeBlock& slab) {
    sides.resize(static_cast<std::size_t>(slab.size()));
    const Tally of_slab = evaluator.evaluate_sides(rule, lattice, slab, sides, done);
    if (tally) *tally += of_slab;
    const std::int64_t first_j = slab.first[1] - lattice.index_min[1], first_k = slab.first[2] - lattice.index_min[2];
    const auto rows = static_cast<std::size_t>(slab.counts[1] * slab.counts[2]);
    parallel_for(rows, 64, [&](std::size_t begin, std::size_t end) {
      for (auto row = static_cast<std::int64_t>(begin); row < static_cast<std::int64_t>(end); ++row) {
        const auto of_row = std::span<const std::uint8_t>(sides).subspan(static_cast<std::size_t>(row * slab.counts[0]),
                                                                         static_cast<std::size_t>(slab.counts[0]));
        nodes.set_row(first_j + row % slab.counts[1], first_k + row / slab.counts[1], of_row);
      }
    });
  });
  return nodes;
}

double node_set_bytes(const Lattice& lattice) {
  const double layer = static_cast<double>(lattice.counts[0]) * static_cast<double>(lattice.counts[1]);
  const double layers = static_cast<double>(lattice.counts[2]);
  const double bits = (layer + 64.0 * static_cast<double>(lattice.counts[1])) * layers / 8.0;
  const double of_slab = std::max(layer, std::min(layer * layers, static_cast<double>(kSlabNodes)));
  constexpr double kPerSide = 20.0;  // the side, and what finding it takes at most
  return bits + kPerSide * of_slab;
}

}  // namespace raycone
