// Which ways to sum the values of a mesh are open, and which of them pay.
#pragma once

#include <algorithm>
#include <cstddef>

#include "core/boundary/boundary.h"
#include "core/evaluation/winding_number.h"

namespace raycone {

// Chooses between the direct sum, a far field and blocks, by what is asked for and by how much there is to sum. It
// builds nothing: who has built an engine asks whether that pays. Lattices have more to choose (lattice_far.h).
// Costs are at a sample, in units of an exterior edge of the direct sum there (costs.h). Thread-safe.
class SummationChoice {
 public:
  // What the direct sum is of.
  struct DirectSum {
    const Boundary& boundary;  // of the mesh; must outlive the choice
    std::size_t triangles;     // of the mesh
    bool counts_crossings;     // it is over the boundary, not over the triangles
    bool is_in_scale;          // ScaledMesh::is_in_scale()
  };

  SummationChoice(const EvaluatorOptions& options, const DirectSum& direct)
      : summation_(options.summation), accuracy_(options.accuracy), direct_(direct) {}

  // That of the accuracy, where it is of use, turns: more would not be settled at half-integers.
  [[nodiscard]] double tolerance() const { return std::min(accuracy_.tolerance, 0x1p-4); }

  [[nodiscard]] double direct_cost() const;
  // Triangles that a far field or blocks sum, at most.
  [[nodiscard]] double most_sources() const;

  // Whether there may be a far field at all, and the tolerance that it is made with, turns.
  [[nodiscard]] bool may_have_far_field() const;
  [[nodiscard]] double tolerance_of_far_field() const;
  // Whether to make it, to see what it costs; whether it pays then.
  [[nodiscard]] bool far_field_may_pay() const;
  [[nodiscard]] bool far_field_pays(double cost) const;
  // No value of it is off by more, turns. Whether there is one is not known before it is made.
  [[nodiscard]] double doubt_of_far_field() const;

  // Whether blocks may be evaluated: not with a tolerance too small for them, nor with sources so many that no value is
  // sure to half a turn.
  [[nodiscard]] bool has_blocks() const;
  // Whether sides of rules are told by rough sums over the tree of blocks, if these are sound. Few samples of a soup
  // are sooner told by its own far field.
  [[nodiscard]] bool has_rough_sums() const;
  // No value from blocks is off by more, turns.
  [[nodiscard]] double doubt_of_blocks() const;

  // Whether to make blocks of points, to see what they cost; whether they pay then, in place of what costs `other`.
  // `cost`: PointBlocks::cost().
  [[nodiscard]] bool blocks_of_points_may_pay() const;
  [[nodiscard]] bool blocks_of_points_pay(double cost, double other) const;

 private:
  [[nodiscard]] bool is_open() const { return direct_.boundary.exterior_edges() != 0; }

  Summation summation_;
  Accuracy accuracy_;
  DirectSum direct_;
};

}  // namespace raycone
