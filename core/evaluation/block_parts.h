// A block of samples in parts that are evaluated apart.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/data/diagnostics.h"
#include "core/data/lattice.h"

namespace raycone {

// The block cut along each axis wherever `property` of the coordinates of consecutive samples changes: in few parts for
// a property of intervals. Together the parts are the block; none where the block is empty.
[[nodiscard]] std::vector<LatticeBlock> parts_alike(const Lattice& lattice, const LatticeBlock& block,
                                                    const std::function<bool(double)>& property);

// Copies what was computed of a part, x fastest, to its place in a block `whole`.
template <class Number>
void copy_part(const LatticeBlock& whole, const LatticeBlock& part, std::span<const Number> from,
               std::span<Number> to) {
  const LatticeBlock row_starts{part.first, {1, part.counts[1], part.counts[2]}};
  for_each_sample(row_starts, [&](const LatticeIndex& start) {
    const auto row = from.subspan(part.number_of(start), static_cast<std::size_t>(part.counts[0]));
    std::ranges::copy(row, to.subspan(whole.number_of(start)).begin());
  });
}

// Room for what is computed of a part before it finds its place in the whole.
class PartSamples {
 public:
  PartSamples(std::size_t count, bool with_diagnostics);
  PartSamples(const PartSamples&) = delete;  // diagnostics_ refers to its vectors
  PartSamples& operator=(const PartSamples&) = delete;

  [[nodiscard]] std::span<double> values() { return values_; }
  [[nodiscard]] const Diagnostics& diagnostics() const { return diagnostics_; }  // empty without

  // To the places that samples of `part` have in a block `whole`; diagnostics where given.
  void copy_to(const LatticeBlock& whole, const LatticeBlock& part, std::span<double> values,
               const Diagnostics* diagnostics) const;

 private:
  std::vector<double> values_, error_bound_;
  std::vector<std::int64_t> crossings_, degenerate_;
  std::vector<std::uint8_t> on_surface_;
  Diagnostics diagnostics_;
};

}  // namespace raycone
