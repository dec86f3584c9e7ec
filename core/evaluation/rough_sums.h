// Rough sums of solid angles at samples of a lattice: good enough to tell most samples' sides of a threshold.
#pragma once

#include <array>
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

// A box of samples, and what triangles sum to there: what is smooth in it at some of the samples, between which it is
// interpolated, and lists of the rest.
struct RoughBox {
  SampleBox samples;
  NodeGrid nodes;
  std::array<double, kTile> at_nodes{};
  RoughCover cover{};
  double error = 0.0;  // of all that is interpolated, rounding included

  // Whether all is interpolated.
  [[nodiscard]] bool is_smooth() const { return cover.near.cost == 0.0 && cover.unopened.empty(); }
};

// Sums in turns, those of the perturbed queries. For one thread.
class RoughSums {
 public:
  // Of all triangles of `blocks`, in the scale of `rows`. Both must outlive this.
  RoughSums(const LatticeBlocks& blocks, const LatticeRows& rows);

  // A box, with what is not smooth in a box `around` it; of all triangles without. Each part that sums are made of, a
  // group of triangles or one, is off by `each` or so at most. Small boxes may be evaluated, larger ones only divided.
  static constexpr std::size_t kLargest = std::size_t{1} << 12;  // samples
  [[nodiscard]] RoughBox look_at(const SampleBox& samples, double each, const RoughBox* around) const;

  // What evaluate() takes, about, in units of a triangle's solid angle at a sample.
  [[nodiscard]] static double cost(const RoughBox& box);

  // All sums of a box that is smooth are within `off` of `middle`.
  struct Range {
    double middle, off;
  };
  [[nodiscard]] static Range range(const RoughBox& box);

  // Sets the sums, BoxSums of the box, of kLargest samples at most. Returns how far they are off at most, rounding
  // included.
  [[nodiscard]] double evaluate(const RoughBox& box, std::vector<double>& sums);

 private:
  void add_at_nodes(RoughBox& box, const RoughBox* around) const;
  // What a sum over a cover rounds at most.
  [[nodiscard]] double doubt_of(const Cover& cover) const;

  const LatticeBlocks& blocks_;
  const LatticeRows& rows_;
  const LatticeAxes axes_;
  const CoverKernels kernels_;
  const MatrixKernel matrices_;
  const double doubt_;  // what a sum of all solid angles rounds at most, if none is rough
  LatticeCovers covers_;
  LayerValues layer_;
};

}  // namespace raycone
