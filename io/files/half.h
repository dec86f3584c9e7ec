// Numbers of 16 bits (IEEE 754 binary16), held as floats, all of which they are among.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

namespace raycone {

inline constexpr double kLargestHalf = 65504.0;
inline constexpr double kLeastHalf = 0x1p-14;  // with all digits

// The half nearest to `value`, ties to even; beyond the largest one, that. 0 has no sign. Precondition: not NaN.
[[nodiscard]] inline float nearest_half(double value) {
  const double clamped = std::clamp(value, -kLargestHalf, kLargestHalf);
  constexpr std::uint64_t kExponent = 0x7FF0000000000000;
  const auto power_of_two = std::bit_cast<double>(std::bit_cast<std::uint64_t>(clamped) & kExponent);
  // Doubles of its size are as far apart as halves of the value's size.
  const double large = std::max(power_of_two, kLeastHalf) * 0x1.8p42;
  return static_cast<float>((clamped + large) - large);
}

// The next half above the half `half`; of the largest, that.
[[nodiscard]] float next_half_above(float half);

// The bits of a float that is a half, -0 as 0.
[[nodiscard]] inline std::uint16_t bits_of_half(float half) {
  const auto bits = std::bit_cast<std::uint32_t>(half);
  const float magnitude = std::bit_cast<float>(bits & 0x7FFFFFFFU);
  const std::uint32_t sign = magnitude == 0.0F ? 0 : bits >> 16 & 0x8000U;
  constexpr std::uint32_t kBias = (127 - 15) << 10;  // of exponents, in the place that halves have for them
  const std::uint32_t normal = (bits >> 13 & 0x3FFFFU) - kBias;
  const auto least_normal = static_cast<float>(kLeastHalf);
  const auto subnormal =
      static_cast<std::uint32_t>(static_cast<std::int32_t>(std::min(magnitude, least_normal) * 0x1p24F));
  return static_cast<std::uint16_t>(sign | (magnitude < least_normal ? subnormal : normal));
}
// And back. Of exponent 31 infinity, or NaN where digits follow.
[[nodiscard]] float half_from_bits(std::uint16_t bits);

}  // namespace raycone
