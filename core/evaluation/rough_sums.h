// Sums of solid angles at samples of a lattice, as roughly as they do for who asks on which side of something they are.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/boundary/sample_tile.h"
#include "core/crossings/lattice_rows.h"
#include "core/data/sample_box.h"
#include "core/evaluation/lattice_polynomial.h"
#include "core/far/cover.h"
#include "core/far/lattice_axes.h"
#include "core/far/lattice_blocks.h"
#include "core/far/lattice_covers.h"
#include "core/far/matrix_kernel.h"

namespace raycone {

// Sums in turns, those of the perturbed queries, box by box. What is not near a box is summed at some of its samples
// and interpolated. For one thread.
class RoughSums {
 public:
  // Of all triangles of `blocks`, in the scale of `rows`. Both must outlive this.
  RoughSums(const LatticeBlocks& blocks, const LatticeRows& rows);

  // All that follows is about this box. Each part that its sums are made of, a group of triangles or one, is off by
  // `each` or so at most; how far they are off together is known when they are made.
  void look_at(const SampleBox& box, double each);

  // What evaluate() takes, about, in units of a triangle's solid angle at a sample.
  [[nodiscard]] double cost() const;

  // All sums are within `off` of `middle`. Nothing where a triangle is near.
  struct Range {
    double middle, off;
  };
  [[nodiscard]] std::optional<Range> range();

  // Sets the sums, BoxSums of the box. Returns how far they are off at most, rounding included.
  [[nodiscard]] double evaluate(std::vector<double>& sums);

 private:
  void sum_at_nodes();
  void interpolate(const BoxSums& sums);
  [[nodiscard]] double largest_error() const;

  const LatticeBlocks& blocks_;
  const LatticeRows& rows_;
  const LatticeAxes axes_;
  const CoverKernels kernels_;
  const MatrixKernel matrices_;
  const double doubt_;  // what a sum of solid angles rounds at most
  LatticeCovers covers_;

  SampleBox box_{};
  std::optional<NodeGrid> nodes_;  // of the box
  RoughCover cover_;
  std::array<double, kTile> at_nodes_{};  // what is interpolated, once it is summed
  bool summed_ = false;
  LayerValues layer_;
};

}  // namespace raycone
