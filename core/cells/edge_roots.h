// Where edges of a lattice leave a set, as told by functions that are positive inside.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/cells/surface_cells.h"
#include "core/data/rule.h"
#include "core/data/vec3.h"
#include "core/evaluation/winding_number.h"

namespace raycone {

// Two evaluators of one mesh: a fine one, for places where w is a threshold, and a rough one, which is faster, for
// sides.
struct FineAndRough {
  const WindingNumberEvaluator& fine;
  const WindingNumberEvaluator& rough;

  FineAndRough(const WindingNumberEvaluator& for_places, const WindingNumberEvaluator& for_sides)
      : fine(for_places), rough(for_sides) {}
  FineAndRough(const WindingNumberEvaluator& evaluator) : FineAndRough(evaluator, evaluator) {}  // NOLINT: implicit
};

// A rule as a function along edges, continuous between triangles: how far w is from the nearest threshold, in turns,
// positive inside. The evaluators must outlive this.
class RuleAlong {
 public:
  RuleAlong(const FineAndRough& evaluators, const Rule& rule)
      : fine_(evaluators.fine), rough_(evaluators.rough), rule_(rule) {}

  // Rough winding numbers, off by rough_doubt() at most, but on the same side of each threshold of the rule as w.
  [[nodiscard]] std::vector<double> winding_numbers(const std::vector<Vec3>& points) const;
  [[nodiscard]] double rough_doubt() const { return rough_.doubt(); }
  // Whether the rule holds at each point: 1 or 0. Exact.
  [[nodiscard]] std::vector<std::uint8_t> holds_at(const std::vector<Vec3>& points) const;
  [[nodiscard]] bool holds_for(double w) const { return holds(rule_, w); }
  // What the function is where the winding number is `w`.
  [[nodiscard]] double from_threshold(double w) const {
    return holds_for(w) ? distance_to_threshold(rule_, w) : -distance_to_threshold(rule_, w);
  }
  // The function for a search of roots. Off by rounding, even where that changes its sign.
  [[nodiscard]] std::vector<double> near(const std::vector<Vec3>& points) const;
  // The function from rough values; where these might have the wrong sign, from fine ones.
  [[nodiscard]] std::vector<double> roughly_near(const std::vector<Vec3>& points) const;
  [[nodiscard]] bool is_closed() const { return fine_.exterior_edges() == 0; }

 private:
  const WindingNumberEvaluator &fine_, &rough_;
  Rule rule_;
};

// Two places on an edge between which it leaves the set.
struct Bracket {
  MixedEdge edge;
  double low, high;      // inside, outside: fractions of the way from edge.inside to edge.outside
  double root = 0.0;     // likewise, between them; set by find_roots()
  bool at_jump = false;  // values do not pass 0 there, but jump past it, as at triangles
};

// Answers for many points at once: a value per point, which does not depend on the other points.
using ValuesAt = std::function<std::vector<double>(const std::vector<Vec3>&)>;

// Sets the root of each bracket: where values are 0, to 2^-34 of the edge (Chandrupatla 1997); where they jump past 0,
// the place of the jump. Uses the threads that ThreadLimit allows.
void find_roots(std::vector<Bracket>& brackets, const ValuesAt& values_at);

}  // namespace raycone
