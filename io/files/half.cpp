#include "io/files/half.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycone {
namespace {

constexpr int kLeastExponent = -14, kFractionBits = 10;  // of normal numbers; behind the point
constexpr int kNoNumber = 31;                            // the exponent's field
constexpr std::uint16_t kSign = 0x8000, kMagnitude = 0x7FFF;

}  // namespace

float half_from_bits(std::uint16_t bits) {
  const int field = (bits & kMagnitude) >> kFractionBits, digits = bits & ((1 << kFractionBits) - 1);
  const int leading = field == 0 ? 0 : 1 << kFractionBits;
  double magnitude = std::ldexp(leading + digits, std::max(field, 1) - 1 + kLeastExponent - kFractionBits);
  if (field == kNoNumber) magnitude = digits == 0 ? std::numeric_limits<double>::infinity() : std::nan("");
  return static_cast<float>((bits & kSign) != 0 ? -magnitude : magnitude);
}

float next_half_above(float half) {
  if (static_cast<double>(half) >= kLargestHalf) return half;
  const std::uint16_t bits = bits_of_half(half);
  return half_from_bits(static_cast<std::uint16_t>((bits & kSign) != 0 ? bits - 1 : bits + 1));
}

}  // namespace raycone
