#include "io/files/half.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycone {
namespace {

constexpr int kLeastExponent = -14, kDigits = 10;  // of normal numbers; behind the point
constexpr int kNoNumber = 31;                      // the exponent's field
constexpr std::uint16_t kSign = 0x8000, kMagnitude = 0x7FFF;

}  // namespace

float nearest_half(double value) {
  const double clamped = std::clamp(value, -kLargestHalf, kLargestHalf);
  const int exponent = std::max(clamped == 0.0 ? kLeastExponent : std::ilogb(clamped), kLeastExponent);
  const double step = std::ldexp(1.0, exponent - kDigits);
  return static_cast<float>(std::nearbyint(clamped / step) * step);
}

std::uint16_t bits_of_half(float half) {
  const double magnitude = std::abs(static_cast<double>(half));
  if (magnitude == 0.0) return 0;
  const int exponent = std::max(std::ilogb(magnitude), kLeastExponent);
  // The leading bit of normal numbers adds one to the exponent's field, which is biased by one less for that.
  const auto digits = static_cast<int>(std::ldexp(magnitude, kDigits - exponent));
  const int bits = ((exponent - kLeastExponent) << kDigits) + digits;
  return static_cast<std::uint16_t>(bits | (half < 0.0F ? kSign : 0));
}

float half_from_bits(std::uint16_t bits) {
  const int field = (bits & kMagnitude) >> kDigits, digits = bits & ((1 << kDigits) - 1);
  const int leading = field == 0 ? 0 : 1 << kDigits;
  double magnitude = std::ldexp(leading + digits, std::max(field, 1) - 1 + kLeastExponent - kDigits);
  if (field == kNoNumber) magnitude = digits == 0 ? std::numeric_limits<double>::infinity() : std::nan("");
  return static_cast<float>((bits & kSign) != 0 ? -magnitude : magnitude);
}

float next_half_above(float half) {
  if (static_cast<double>(half) >= kLargestHalf) return half;
  const std::uint16_t bits = bits_of_half(half);
  return half_from_bits(static_cast<std::uint16_t>((bits & kSign) != 0 ? bits - 1 : bits + 1));
}

}  // namespace raycone
