// Counts and rates for people.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <string>

namespace raycone {

// With three significant digits and the prefix of `unit`: "4.2 Msamples/s", "870 samples/s"; "4.2 M" and "870" where
// there is none. `count`: 0 or more.
[[nodiscard]] inline std::string readable_count(double count, const std::string& unit = {}) {
  constexpr const char* kPrefixes[] = {"", "k", "M", "G"};
  constexpr double kRoundedUp = 999.5;  // would be 1e+03
  std::size_t prefix = 0;
  for (; count >= kRoundedUp && prefix + 1 < std::size(kPrefixes); ++prefix) count /= 1000.0;
  char number[32];
  std::snprintf(number, sizeof number, "%.3g", count);
  const std::string behind = kPrefixes[prefix] + unit;
  return behind.empty() ? number : number + (' ' + behind);
}

// In groups of three digits: "1 234 567".
[[nodiscard]] inline std::string grouped(std::uint64_t count, const char* between = " ") {
  std::string digits = std::to_string(count);
  for (std::size_t end = digits.size(); end > 3; end -= 3) digits.insert(end - 3, between);
  return digits;
}

}  // namespace raycone
