// Where edges of a lattice leave a set, as functions tell that are positive inside.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/data/rule.h"
#include "core/data/vec3.h"
#include "core/evaluation/winding_number.h"
#include "core/surface/surface_cells.h"

namespace raycone {

// The rule along edges, a continuous function between triangles: positive inside, turns.
class RuleAlong {
 public:
  RuleAlong(const WindingNumberEvaluator& evaluator, const Rule& rule) : evaluator_(evaluator), rule_(rule) {}

  [[nodiscard]] std::vector<double> at(const std::vector<Vec3>& points) const;
  // Whether the rule holds at points, 1, or not, 0: exactly, whatever the evaluator's tolerance is.
  [[nodiscard]] std::vector<std::uint8_t> holds_at(const std::vector<Vec3>& points) const;
  // The winding numbers themselves, on the side of half-integers where w is; and what such a one is, as at() has it.
  [[nodiscard]] std::vector<double> winding_numbers(const std::vector<Vec3>& points) const;
  [[nodiscard]] double from_threshold(double w) const {
    return holds(rule_, w) ? distance_to_threshold(rule_, w) : -distance_to_threshold(rule_, w);
  }
  // The same for the search of roots, sooner: off by rounding also where that makes it another sign.
  [[nodiscard]] std::vector<double> near(const std::vector<Vec3>& points) const;
  [[nodiscard]] bool is_closed() const { return evaluator_.exterior_edges() == 0; }

 private:
  const WindingNumberEvaluator& evaluator_;
  Rule rule_;
};

// Two places of an edge, between which it leaves the set.
struct Bracket {
  MixedEdge edge;
  double low, high;   // inside, outside
  double root = 0.0;  // between them, as find_roots() leaves it
};

// Answers for many points at once: a value for each, that does not depend on the others.
using ValuesAt = std::function<std::vector<double>(const std::vector<Vec3>&)>;

// Narrows brackets to 2^-34 of their edges (Chandrupatla 1997), and finds where values are 0 if they change evenly
// between the ends.
void find_roots(std::vector<Bracket>& brackets, const ValuesAt& values_at);

}  // namespace raycone
