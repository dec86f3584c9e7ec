// Where one part of a job is: which samples the rule holds for.
#pragma once

#include "app/fields/field_evaluator.h"
#include "app/input/mesh_input.h"
#include "app/options/field_options.h"
#include "core/data/interval.h"
#include "core/data/placed_lattice.h"

namespace raycone {

class PartEvaluator {
 public:
  // `samples`: about how many it is for.
  PartEvaluator(MeshToEvaluate part, const FieldOptions& options, double samples);

  // The samples of `lattice` that may be inside: those of the part's box where it is closed, outside is outside, and
  // the lattice lies along the axes.
  [[nodiscard]] static LatticeBlock reach(const PlacedLattice& lattice, const MeshToEvaluate& part, const Rule& rule);

  // What is asked of the part: whether the rule holds.
  [[nodiscard]] static FieldOptions options_of(const FieldOptions& options);

  [[nodiscard]] const FieldEvaluator& evaluator() const { return evaluator_; }

  // Where the rule may hold: along x, and at `point`.
  [[nodiscard]] Interval reach_along_x() const;
  [[nodiscard]] bool reaches(const Vec3& point) const;

 private:
  Box box_;
  bool bounded_;
  FieldEvaluator evaluator_;
};

}  // namespace raycone
