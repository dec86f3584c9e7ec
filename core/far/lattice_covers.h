// Covers at the samples of a lattice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/data/box.h"
#include "core/data/sample_box.h"
#include "core/far/cover.h"
#include "core/far/harmonic_polynomial.h"
#include "core/far/lattice_axes.h"
#include "core/far/shared_edges.h"
#include "core/far/source_tree.h"

namespace raycone {

// Sums of the samples of a box, in rows of GridValues::row_size().
struct BoxSums {
  std::vector<double>& numbers;
  SampleBox samples;

  [[nodiscard]] std::size_t row_size() const { return GridValues::row_size(samples.side(0)); }
  [[nodiscard]] std::size_t size() const { return row_size() * samples.side(1) * samples.side(2); }
  [[nodiscard]] std::size_t place(std::size_t x, std::size_t y, std::size_t z) const {
    return ((z - samples.begin[2]) * samples.side(1) + y - samples.begin[1]) * row_size() + x - samples.begin[0];
  }
  // The row (y, z) of the box.
  [[nodiscard]] std::span<double> row(std::size_t y, std::size_t z) const {
    return std::span(numbers).subspan(place(samples.begin[0], y, z), samples.side(0));
  }
};

// For one thread. Ties are decided as the exactness rules say, so sums are those of the perturbed queries.
class LatticeCovers {
 public:
  // `edges`, where given, are those of the tree's triangles: near ones are summed by their boundary where that has few.
  // All must outlive this.
  LatticeCovers(const SourceTree& tree, const LatticeAxes& axes, const CoverKernels& kernels, const SharedEdges* edges);

  // Adds what the cover sums to at `samples`, some of those of `sums`, to these. They must be within `box`, in which
  // the cover's expansions hold; values depend on this box, but not on which of its samples are asked for.
  void add(const Cover& cover, const Box& box, const SampleBox& samples, const BoxSums& sums);

 private:
  void add_crossings(std::span<const std::uint32_t> triangles, const SampleBox& samples, const BoxSums& sums) const;
  void add_in_rows(CoverSums& cover, const SampleBox& samples, const BoxSums& sums) const;
  void add_one_by_one(CoverSums& cover, const SampleBox& samples, const BoxSums& sums) const;

  const SourceTree& tree_;
  const LatticeAxes& axes_;
  CoverKernels kernels_;
  std::optional<SharedEdges::Boundary> boundary_;
};

}  // namespace raycone
