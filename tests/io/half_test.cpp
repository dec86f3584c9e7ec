// Numbers of 16 bits against their definition: all of them, and doubles between neighbours.
#include "io/files/half.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace raycone {
namespace {

// Sign, exponent biased by 15, ten digits (IEEE 754-2019, 3.4).
double by_definition(unsigned bits) {
  const double sign = (bits & 0x8000) != 0 ? -1.0 : 1.0;
  const int exponent = static_cast<int>(bits >> 10 & 31);
  const double digits = bits & 1023;
  return sign * (exponent == 0 ? digits * 0x1p-24 : (1024 + digits) * std::ldexp(1.0, exponent - 25));
}

TEST(Half, AllOfThemAreWhatTheirBitsSay) {
  for (unsigned bits = 0; bits < 0x7C00; ++bits) {
    for (const unsigned sign : {0U, 0x8000U}) {
      const auto signed_bits = static_cast<std::uint16_t>(bits | sign);
      ASSERT_EQ(half_from_bits(signed_bits), by_definition(signed_bits)) << bits;
      ASSERT_EQ(bits_of_half(half_from_bits(signed_bits)), bits == 0 ? 0 : signed_bits) << bits;
    }
  }
}

TEST(Half, ThoseOfExponent31AreNoNumbers) {
  EXPECT_EQ(half_from_bits(0x7C00), HUGE_VALF);
  EXPECT_EQ(half_from_bits(0xFC00), -HUGE_VALF);
  for (const int bits : {0x7C01, 0x7E00, 0x7FFF, 0xFE00}) {
    EXPECT_TRUE(std::isnan(half_from_bits(static_cast<std::uint16_t>(bits))));
  }
}

TEST(Half, TheNearestIsNearestWithTiesToEven) {
  for (unsigned bits = 0; bits + 1 < 0x7C00; ++bits) {
    const double low = by_definition(bits), high = by_definition(bits + 1), middle = (low + high) / 2;
    const double even = bits % 2 == 0 ? low : high;
    for (const double sign : {1.0, -1.0}) {
      ASSERT_EQ(nearest_half(sign * low), sign * low);
      ASSERT_EQ(nearest_half(sign * middle), sign * even);
      ASSERT_EQ(nearest_half(sign * std::nextafter(middle, 0.0)), sign * low);
      ASSERT_EQ(nearest_half(sign * std::nextafter(middle, 1e9)), sign * high);
    }
    ASSERT_EQ(next_half_above(static_cast<float>(low)), high);
    ASSERT_EQ(next_half_above(static_cast<float>(-high)), -low);
  }
  EXPECT_EQ(next_half_above(65504.0F), 65504.0F);
  EXPECT_EQ(next_half_above(-65504.0F), -65472.0F);
  EXPECT_EQ(nearest_half(1e300), kLargestHalf);
  EXPECT_EQ(nearest_half(-1e300), -kLargestHalf);
  EXPECT_EQ(nearest_half(5e-324), 0.0F);
}

}  // namespace
}  // namespace raycone
