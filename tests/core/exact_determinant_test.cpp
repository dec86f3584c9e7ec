// Determinants in 106 bits against those in exact arithmetic.
#include "core/exact/exact_determinant.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "core/machine/floating_point.h"

namespace raycone {
namespace {

// Bit by bit; -0 is 0.
void expect_equal(const Difference& a, const Difference& b, const Difference& c, const Difference& d) {
  const double expected = static_cast<double>(determinant(a, b, c, d)) + 0.0;
  const double found = rounded_determinant(a, b, c, d);
  const bool both_are_nan = std::isnan(expected) && std::isnan(found);
  ASSERT_TRUE(both_are_nan || std::bit_cast<std::uint64_t>(expected) == std::bit_cast<std::uint64_t>(found))
      << found << ", expected " << expected;
}

class ExactDeterminant : public testing::Test {
 protected:
  double number() { return std::ldexp(mantissa_(random_), exponent_(random_)); }
  Difference pair() { return difference(number(), number()); }

  std::mt19937_64 random_{1};
  std::uniform_real_distribution<double> mantissa_{-1.0, 1.0};
  std::uniform_int_distribution<int> exponent_{-4, 0};

 private:
  DefaultFloatingPoint guard_;
};

TEST_F(ExactDeterminant, IsRoundedAsExactOnesAre) {
  for (int i = 0; i < 100'000; ++i) expect_equal(pair(), pair(), pair(), pair());
}

TEST_F(ExactDeterminant, IsRightWhereItCancels) {
  for (int i = 0; i < 30'000; ++i) {
    // Rows that are parallel but for a few bits, or wholly.
    const double x = number(), y = number(), s = std::ldexp(1.0, exponent_(random_));
    const double off = i % 3 == 0 ? 0.0 : std::ldexp(mantissa_(random_), -static_cast<int>(random_() % 100));
    expect_equal(difference(x, 0), difference(y, 0), difference(s * x, 0), difference(s * y, off * y));
    expect_equal(difference(x, y), difference(y, x), difference(x, y), difference(y, x));
  }
}

// As of faces of no area: rows that are parallel, or but for the last bit of a number.
TEST_F(ExactDeterminant, IsRightWhereItCancelsAtAllMagnitudes) {
  std::size_t zeros = 0;
  for (const int least : {-600, -560, -430, -300, 0, 400}) {
    exponent_ = std::uniform_int_distribution<int>(least, least + 60);
    for (int i = 0; i < 20'000; ++i) {
      const auto few_bits = [&] { return static_cast<double>(static_cast<float>(number())); };
      const double x = few_bits(), y = few_bits(), s = static_cast<double>(1 + random_() % 7);
      const double last = i % 3 == 0 ? s * y : std::nextafter(s * y, i % 3 == 1 ? -1.0 : 1.0);
      expect_equal(difference(x, 0), difference(y, 0), difference(s * x, 0), difference(last, 0));
      expect_equal(difference(x, 0), difference(s * x, 0), difference(0, y), difference(0, last));
      zeros += rounded_determinant({x, 0}, {y, 0}, {s * x, 0}, {last, 0}) == 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(zeros, 30'000U);
}

TEST_F(ExactDeterminant, IsRightInTheMiddleBetweenDoubles) {
  for (int i = 0; i < 10'000; ++i) {
    // x (1 + 2^-53) and its like: halves of the last place, and next to them.
    const double x = 1.0 + std::ldexp(static_cast<double>(random_() >> 12), -52);
    const double tiny = i % 2 == 0 ? 0.0 : std::ldexp(mantissa_(random_), -110);
    expect_equal(difference(x, 0), difference(0x1p-53, 0), difference(-tiny, -1), difference(1, 0));
    expect_equal(difference(x, 0), difference(0x1p-54, 0), difference(0, 1), difference(1, 0));
  }
}

TEST_F(ExactDeterminant, IsRightAtAllMagnitudes) {
  exponent_ = std::uniform_int_distribution<int>(-600, 500);
  for (int i = 0; i < 30'000; ++i) expect_equal(pair(), pair(), pair(), pair());
  exponent_ = std::uniform_int_distribution<int>(-560, -480);  // products underflow
  for (int i = 0; i < 30'000; ++i) expect_equal(pair(), pair(), pair(), pair());
  const double most = std::numeric_limits<double>::max();
  expect_equal(difference(most, -most), difference(1, 0), difference(0, 1), difference(most, 0));
  expect_equal(difference(0, 0), difference(-1, 0), difference(1, 0), difference(0, 0));
  // Products that are 0 in doubles, and half the least double each.
  expect_equal(difference(0x1p-537, 0), difference(0x1p-538, 0), difference(-0x1p-537, 0), difference(0x1p-538, 0));
}

}  // namespace
}  // namespace raycone
