// Numbers of 16 bits (IEEE 754 binary16), held as floats, all of which they are among.
#pragma once

#include <cstdint>

namespace raycone {

inline constexpr double kLargestHalf = 65504.0;
inline constexpr double kLeastHalf = 0x1p-14;  // with all digits

// The half nearest to `value`, ties to even; beyond the largest one, that. Precondition: not NaN.
[[nodiscard]] float nearest_half(double value);

// The next half above the half `half`; of the largest, that.
[[nodiscard]] float next_half_above(float half);

// The bits of a float that is a half, -0 as 0.
[[nodiscard]] std::uint16_t bits_of_half(float half);
// And back. Of exponent 31 infinity, or NaN where digits follow.
[[nodiscard]] float half_from_bits(std::uint16_t bits);

}  // namespace raycone
