#include "core/far/gauss_rule.h"

#include <cmath>
#include <numbers>

namespace raycone {
namespace {

// By Newton's method from Chebyshev's points.
GaussRule make_rule(std::size_t points) {
  GaussRule rule{points, {}, {}};
  const int n = static_cast<int>(points);
  for (int i = 0; i < n; ++i) {
    long double x = std::cos(std::numbers::pi_v<long double> * (i + 0.75L) / (n + 0.5L)), slope = 1;
    for (int step = 0; step < 8; ++step) {
      long double before = 1, value = x;
      for (int k = 2; k <= n; ++k) {
        const long double next = ((2 * k - 1) * x * value - (k - 1) * before) / k;
        before = value;
        value = next;
      }
      slope = n * (x * value - before) / (x * x - 1);
      x -= value / slope;
    }
    rule.at[static_cast<std::size_t>(i)] = static_cast<double>((1 + x) / 2);
    rule.weight[static_cast<std::size_t>(i)] = static_cast<double>(1 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

}  // namespace

const GaussRule& gauss_rule(std::size_t points) {
  static const std::array<GaussRule, GaussRule::kMost> rules = [] {
    std::array<GaussRule, GaussRule::kMost> all;
    for (std::size_t n = 0; n < all.size(); ++n) all[n] = make_rule(n + 1);
    return all;
  }();
  return rules[points - 1];
}

}  // namespace raycone
