#include "core/machine/numbers_where.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace raycone {
namespace {

TEST(NumbersWhere, AreThoseOfALoop) {
  // Chunks have 2^15 numbers: none, one, whole ones, and some more.
  for (const std::size_t count : {0U, 1U, 32767U, 32768U, 32769U, 100'000U}) {
    for (const std::uint32_t divisor : {1U, 3U, 40'000U, 1'000'000U}) {
      const auto holds = [divisor](std::uint32_t n) { return n % divisor == divisor - 1; };
      std::vector<std::uint32_t> expected;
      for (std::uint32_t n = 0; n < count; ++n) {
        if (holds(n)) expected.push_back(n);
      }
      EXPECT_EQ(numbers_where(count, holds), expected) << count << " " << divisor;
    }
  }
}

TEST(FirstTouch, KeepsWhatThereWasAndAddsZeros) {
  std::vector<double> numbers(3000, 7.0);
  resize_on_all_threads(numbers, 2'000'000);
  ASSERT_EQ(numbers.size(), 2'000'000U);
  for (std::size_t n = 0; n < numbers.size(); ++n) ASSERT_EQ(numbers[n], n < 3000 ? 7.0 : 0.0) << n;
  resize_on_all_threads(numbers, 10);
  EXPECT_EQ(numbers, std::vector<double>(10, 7.0));
  EXPECT_TRUE(sized_on_all_threads<int>(0).empty());
}

}  // namespace
}  // namespace raycone
