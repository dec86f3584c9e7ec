// Tests of distributions. Their limits are six standard deviations out: with fixed seeds they hold or they do not, and
// of a billion seeds about one would be refused wrongly.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace raycone::test {

// How far the counts of cells are from what their shares (of sum 1) of the total let expect: the statistic of Pearson's
// chi-squared test over its limit (Wilson and Hilferty 1931); above 1: not that distribution. Cells in which fewer than
// five are expected are taken together; infinite where nothing is expected but something counted.
[[nodiscard]] inline double chi_squared(const std::vector<std::size_t>& counts, const std::vector<double>& shares) {
  double total = 0, statistic = 0, few_expected = 0, few_counted = 0;
  for (const std::size_t count : counts) total += static_cast<double>(count);
  std::size_t cells = 0;
  const auto add = [&](double counted, double expected) {
    statistic += (counted - expected) * (counted - expected) / expected;
    ++cells;
  };
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double counted = static_cast<double>(counts[i]), expected = shares.at(i) * total;
    if (expected >= 5) {
      add(counted, expected);
    } else {
      few_expected += expected;
      few_counted += counted;
    }
  }
  if (few_expected >= 5) add(few_counted, few_expected);
  // As rare as the limit of the others: more than this many of five expected, or any where none is.
  constexpr double kMost = 24;
  if (few_expected < 5 && few_counted > (few_expected > 1e-9 ? kMost : 0)) return HUGE_VAL;
  const auto freedom = static_cast<double>(cells - 1);
  const double limit = freedom * std::pow(1 - 2 / (9 * freedom) + 6 * std::sqrt(2 / (9 * freedom)), 3);
  return statistic / limit;
}

[[nodiscard]] inline double chi_squared(const std::vector<std::size_t>& counts) {
  return chi_squared(counts, std::vector<double>(counts.size(), 1.0 / static_cast<double>(counts.size())));
}

// The statistic of Kolmogorov's and Smirnov's test for the normal distribution of mean 0 and variance 1, over its
// limit.
[[nodiscard]] inline double kolmogorov_smirnov_of_normal(std::vector<double> numbers) {
  std::sort(numbers.begin(), numbers.end());
  const auto n = static_cast<double>(numbers.size());
  double largest = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const double expected = 0.5 * std::erfc(-numbers[i] / std::sqrt(2.0)), at = static_cast<double>(i);
    const double apart = std::max(std::abs(at / n - expected), std::abs((at + 1) / n - expected));
    if (!(apart <= largest)) largest = std::isnan(apart) ? HUGE_VAL : apart;
  }
  constexpr double kLimit = 3.28;  // 2 exp(-2 x^2) = 1e-9
  return largest * std::sqrt(n) / kLimit;
}

}  // namespace raycone::test
