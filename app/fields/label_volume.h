// The labels of a whole lattice, in memory: parts are evaluated one after the other, and each can change any sample.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "app/options/mesh_options.h"
#include "core/data/lattice.h"

namespace raycone {

class LabelVolume {
 public:
  // All 0. Labels are at most `parts`.
  LabelVolume(const Lattice& lattice, std::size_t parts);

  // Bytes that such a volume takes.
  [[nodiscard]] static double bytes(const Lattice& lattice, std::size_t parts);

  // Gives `label` to the samples of a block that are `inside` (x fastest). Where the first part has priority, those
  // that have a label keep it.
  void add(const LatticeBlock& block, std::span<const std::uint8_t> inside, std::int32_t label, PartPriority priority);

  void copy(const LatticeBlock& block, std::span<std::int32_t> labels) const;
  // Of a sample by its number, x fastest, then y, then z.
  [[nodiscard]] std::int32_t at(std::uint64_t number) const;
  // Per label, from 0, how many samples have it.
  [[nodiscard]] std::vector<std::uint64_t> counts() const;

 private:
  // Calls visit(where, n, count) for each row: `count` samples, from index `where` here, n in the block.
  template <typename Visit>
  void for_rows(const LatticeBlock& block, const Visit& visit) const;

  Lattice lattice_;
  std::size_t parts_;
  std::variant<std::vector<std::uint8_t>, std::vector<std::uint16_t>, std::vector<std::int32_t>> labels_;
};

}  // namespace raycone
