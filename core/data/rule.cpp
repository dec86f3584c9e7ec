#include "core/data/rule.h"

#include <cmath>

namespace raycone {
namespace {

// floor(w + 1/2) without rounding of the sum: 0.49999999999999994 + 0.5 is 1 in double.
double rounded_half_up(double w) {
  const double below = std::floor(w);
  return w - below >= 0.5 ? below + 1.0 : below;
}

}  // namespace

std::vector<double> thresholds_to_settle(const Rule& rule) {
  const bool has_threshold = rule.kind == RuleKind::kThreshold || rule.kind == RuleKind::kAbs;
  if (!has_threshold || std::abs(std::fmod(rule.threshold, 1.0)) == 0.5) return {};
  if (rule.kind == RuleKind::kThreshold) return {rule.threshold};
  return rule.threshold > 0.0 ? std::vector{rule.threshold, -rule.threshold} : std::vector<double>{};
}

double distance_to_threshold(const Rule& rule, double w) {
  switch (rule.kind) {
    case RuleKind::kThreshold:
      return std::abs(w - rule.threshold);
    case RuleKind::kAbs:
      return std::abs(std::abs(w) - rule.threshold);
    case RuleKind::kNonzero:
      return std::abs(std::abs(w) - 0.5);
    case RuleKind::kPositive:
      return std::abs(w - 0.5);
    case RuleKind::kOdd:
      return 0.5 - std::abs(w - rounded_half_up(w));
  }
  return 0.0;
}

bool ignores_orientation(const Rule& rule) {
  return rule.kind == RuleKind::kAbs || rule.kind == RuleKind::kNonzero || rule.kind == RuleKind::kOdd;
}

bool holds(const Rule& rule, double w) {
  switch (rule.kind) {
    case RuleKind::kThreshold:
      return w >= rule.threshold;
    case RuleKind::kAbs:
      return std::abs(w) >= rule.threshold;
    case RuleKind::kNonzero:
      return rounded_half_up(w) != 0.0;
    case RuleKind::kPositive:
      return rounded_half_up(w) > 0.0;
    case RuleKind::kOdd:
      return std::fmod(rounded_half_up(w), 2.0) != 0.0;
  }
  return false;
}

}  // namespace raycone
