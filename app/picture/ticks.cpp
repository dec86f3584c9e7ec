#include "app/picture/ticks.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "io/files/ascii.h"

namespace raycone {
namespace {

constexpr std::int64_t kMostTicks = 20;

// Multiples beyond this are told apart by nobody, and their differences are rounded.
constexpr double kLargestMultiple = 1e15;

// Numbers of more digits get an offset that ends in this many zeros.
constexpr std::int64_t kLongNumber = 1'000'000;
constexpr std::int64_t kOffsetUnit = 1'000;

// digit * 10^exponent
struct RoundStep {
  std::int64_t digit;
  int exponent;
};

// The double nearest to count * 10^exponent: a product would be off by rounding, and show it in print.
double decimal(std::int64_t count, int exponent) {
  const std::string text = std::to_string(count) + "e" + std::to_string(exponent);
  double value = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

// "1.5e-9" rather than "1.5e-09".
std::string with_short_exponent(std::string text) {
  const std::size_t e = text.find('e');
  if (e == std::string::npos) return text;
  if (text[e + 1] == '+') text.erase(e + 1, 1);
  const std::size_t digits = text[e + 1] == '-' ? e + 2 : e + 1;
  if (text[digits] == '0') text.erase(digits, 1);
  return text;
}

// All numbers of an axis are printed in one way.
std::string printed(double value, const RoundStep& step, double largest) {
  if (value == 0.0) return "0";
  const bool fixed = step.exponent >= -4 && largest < 1e6;
  std::array<char, 400> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value,
                                          fixed ? std::chars_format::fixed : std::chars_format::scientific);
  return with_short_exponent({text.data(), end});
}

std::string printed_offset(std::int64_t count, const RoundStep& step) {
  const double offset = decimal(count, step.exponent);
  return (offset < 0.0 ? " + " : " - ") + with_short_exponent(shortest_text(std::abs(offset)));
}

// The multiples first * step to last * step.
Ticks multiples(std::int64_t first, std::int64_t last, const RoundStep& step) {
  const std::int64_t from = first * step.digit;
  const std::int64_t to = last * step.digit;
  std::int64_t offset = 0;
  if (std::max(std::abs(from), std::abs(to)) >= kLongNumber) {
    const std::int64_t middle = from + (to - from) / 2;
    const std::int64_t half = middle < 0 ? -kOffsetUnit / 2 : kOffsetUnit / 2;
    offset = (middle + half) / kOffsetUnit * kOffsetUnit;
  }
  const double largest = decimal(std::max(std::abs(from - offset), std::abs(to - offset)), step.exponent);
  Ticks ticks;
  for (std::int64_t count = from; count <= to; count += step.digit) {
    ticks.marks.push_back(
        {decimal(count, step.exponent), printed(decimal(count - offset, step.exponent), step, largest)});
  }
  if (offset != 0) ticks.offset = printed_offset(offset, step);
  return ticks;
}

// Nothing where there are none, or too many.
Ticks multiples_between(double least, double most, const RoundStep& step) {
  constexpr double kRoundingSlack = 1e-9;  // an end that is a multiple up to rounding has its tick
  const double size = decimal(step.digit, step.exponent);
  const double first = std::ceil(least / size - kRoundingSlack);
  const double last = std::floor(most / size + kRoundingSlack);
  if (!(std::max(std::abs(first), std::abs(last)) < kLargestMultiple)) return {};
  if (!(last >= first) || last - first >= static_cast<double>(kMostTicks)) return {};
  return multiples(static_cast<std::int64_t>(first), static_cast<std::int64_t>(last), step);
}

}  // namespace

Ticks round_ticks(double one_end, double other_end, const std::function<bool(const Ticks&)>& fits) {
  const auto [least, most] = std::minmax(one_end, other_end);
  const double range = most - least;
  if (!std::isfinite(range) || !(range > 0.0)) return {};
  const int decade = static_cast<int>(std::floor(std::log10(range)));
  Ticks coarsest;
  for (int exponent = decade - 2; exponent <= decade + 1; ++exponent) {
    for (const std::int64_t digit : {1, 2, 5}) {
      Ticks ticks = multiples_between(least, most, {digit, exponent});
      if (ticks.marks.empty()) continue;
      if (fits(ticks)) return ticks;
      coarsest = std::move(ticks);
    }
  }
  if (!coarsest.marks.empty()) coarsest.marks = {coarsest.marks[coarsest.marks.size() / 2]};
  return coarsest;
}

}  // namespace raycone
