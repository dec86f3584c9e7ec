// Where edges of a lattice leave a set, as functions tell that are positive inside.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/cells/surface_cells.h"
#include "core/data/rule.h"
#include "core/data/vec3.h"
#include "core/evaluation/winding_number.h"

namespace raycone {

// Of one mesh: a fine one for places where w is a threshold, and a rough one, which is sooner, for sides.
struct FineAndRough {
  const WindingNumberEvaluator& fine;
  const WindingNumberEvaluator& rough;

  FineAndRough(const WindingNumberEvaluator& for_places, const WindingNumberEvaluator& for_sides)
      : fine(for_places), rough(for_sides) {}
  FineAndRough(const WindingNumberEvaluator& evaluator) : FineAndRough(evaluator, evaluator) {}  // NOLINT: implicit
};

// The rule along edges, a continuous function between triangles: positive inside, turns.
class RuleAlong {
 public:
  RuleAlong(const FineAndRough& evaluators, const Rule& rule)
      : fine_(evaluators.fine), rough_(evaluators.rough), rule_(rule) {}

  // Rough winding numbers, off by rough_doubt() at most, but on the same side of each threshold of the rule as w.
  [[nodiscard]] std::vector<double> winding_numbers(const std::vector<Vec3>& points) const;
  [[nodiscard]] double rough_doubt() const { return rough_.doubt(); }
  // Whether the rule holds at points, 1, or not, 0: exactly.
  [[nodiscard]] std::vector<std::uint8_t> holds_at(const std::vector<Vec3>& points) const;
  [[nodiscard]] bool holds_for(double w) const { return holds(rule_, w); }
  // What the function is where w is this.
  [[nodiscard]] double from_threshold(double w) const {
    return holds_for(w) ? distance_to_threshold(rule_, w) : -distance_to_threshold(rule_, w);
  }
  // The function for the search of roots: off by rounding also where that makes it another sign.
  [[nodiscard]] std::vector<double> near(const std::vector<Vec3>& points) const;
  // Its signs, of rough values but where these may have others.
  [[nodiscard]] std::vector<double> roughly_near(const std::vector<Vec3>& points) const;
  [[nodiscard]] bool is_closed() const { return fine_.exterior_edges() == 0; }

 private:
  const WindingNumberEvaluator &fine_, &rough_;
  Rule rule_;
};

// Two places of an edge, between which it leaves the set.
struct Bracket {
  MixedEdge edge;
  double low, high;      // inside, outside: parts of the way from the one node to the other
  double root = 0.0;     // between them, as find_roots() leaves it
  bool at_jump = false;  // values do not pass 0 there, but jump past it, as at triangles
};

// Answers for many points at once: a value for each, that does not depend on the others.
using ValuesAt = std::function<std::vector<double>(const std::vector<Vec3>&)>;

// Finds places where values are 0, each between the ends of a bracket, to 2^-34 of the edge (Chandrupatla 1997); where
// values jump past 0, the place of the jump.
void find_roots(std::vector<Bracket>& brackets, const ValuesAt& values_at);

}  // namespace raycone
