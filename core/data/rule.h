// Rules that turn a winding number into inside or outside.
#pragma once

#include <vector>

namespace raycone {

enum class RuleKind {
  kThreshold,  // w >= threshold
  kAbs,        // |w| >= threshold
  kNonzero,    // of the integer nearest to w, floor(w + 1/2): is not 0
  kPositive,   // likewise: is above 0
  kOdd,        // likewise: is odd
};

struct Rule {
  RuleKind kind = RuleKind::kThreshold;
  double threshold = 0.5;  // finite
};

// Numbers of turns that differ by less count as equal where rules decide, so that no decision depends on how well 113
// bits tell them apart: of meshes and samples that are not next to 0, values that differ at all differ by more.
inline constexpr double kIndistinguishable = 1e-24;

// Where the rule changes its mind, but for half-integers, which values are exactly where they are meant
// (core/evaluation/winding_number.h): to be settled before holds() is asked.
[[nodiscard]] std::vector<double> thresholds_to_settle(const Rule& rule);

// Whether a point of winding number `w` (finite) is inside. Exact.
[[nodiscard]] bool holds(const Rule& rule, double w);

}  // namespace raycone
