// Rules that turn a winding number into inside or outside.
#pragma once

#include <cmath>
#include <vector>

namespace raycone {

enum class RuleKind {
  kThreshold,  // w >= threshold
  kAbs,        // |w| >= threshold
  kNonzero,    // floor(w + 1/2), the integer nearest to w, is not 0
  kPositive,   // that integer is above 0
  kOdd,        // that integer is odd
};

struct Rule {
  RuleKind kind = RuleKind::kThreshold;
  double threshold = 0.5;  // finite
};

// Rules take numbers of turns that differ by less as equal. No decision then depends on how well 113 bits tell them
// apart. Of samples that nobody chose for it, about one in 10^24 is so near to a threshold without being equal.
inline constexpr double kIndistinguishable = 1e-24;

// The thresholds of the rule that are not half-integers. A value near one of them must be settled before holds() is
// asked (core/evaluation/winding_number.h). Near half-integers, values need no settling.
[[nodiscard]] std::vector<double> thresholds_to_settle(const Rule& rule);

// How far what was rounded to w, below 2^51, is from the nearest half-integer at least, but for rounding this.
[[nodiscard]] inline double distance_to_half_integer(double w) {
  const double nearest_integer = (w + 0x1.8p52) - 0x1.8p52;
  return 0.5 - std::abs(w - nearest_integer) - 0x1p-53 * std::abs(w);
}

// Whether w may be on the wrong side of `critical` if it is off by `doubt` at most, but for its last rounding.
[[nodiscard]] inline bool may_be_across(double w, double critical, double doubt) {
  return std::abs(w - critical) <= doubt + 0x1p-53 * std::abs(w);
}

// How far w (finite) is from the nearest number where the rule changes its mind, at most: numbers that are nearer to w
// than this are on w's side. Off by rounding, some units of w in the last place.
[[nodiscard]] double distance_to_threshold(const Rule& rule, double w);

// Whether the rule takes w and -w alike, but for w just on a critical value: reversed faces do not matter to it.
[[nodiscard]] bool ignores_orientation(const Rule& rule);

// Whether a point of winding number `w` (finite) is inside. Exact.
[[nodiscard]] bool holds(const Rule& rule, double w);

}  // namespace raycone
