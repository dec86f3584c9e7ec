// Numbers on the command line.
#include "app/text/parse_value.h"

#include <gtest/gtest.h>

namespace raycone::test {
namespace {

TEST(NumberFrom, TakesTheWholeTextOrNothing) {
  EXPECT_EQ(number_from("-.5"), -0.5);
  EXPECT_EQ(number_from("+1e-3"), 1e-3);
  EXPECT_EQ(number_from("12"), 12.0);
  for (const char* const text : {"", "+", "+-1", "-", "1x", "1 ", " 1", "1,2", "0x1p3", "inf", "-nan", "1e400", "1e"}) {
    EXPECT_EQ(number_from(text), std::nullopt) << text;
  }
}

TEST(IntegerFrom, RejectsFractionsAndOverflow) {
  EXPECT_EQ(integer_from("-9223372036854775808"), INT64_MIN);
  for (const char* const text : {"1.0", "1e3", "9223372036854775808", ""}) {
    EXPECT_EQ(integer_from(text), std::nullopt) << text;
  }
}

TEST(NumbersFrom, RejectsEmptyItems) {
  EXPECT_EQ(numbers_from("1,-2,.5"), (std::vector<double>{1, -2, 0.5}));
  for (const char* const text : {"", ",", "1,", ",1", "1,,2", "1, 2"})
    EXPECT_EQ(numbers_from(text), std::nullopt) << text;
}

TEST(ByteCountFrom, KnowsPowersOf1024) {
  EXPECT_EQ(byte_count_from("8G"), 8ULL << 30);
  EXPECT_EQ(byte_count_from("1.5k"), 1536U);
  EXPECT_EQ(byte_count_from("4096"), 4096U);
  for (const char* const text : {"", "G", "0", "-1G", "8GB", "1e30T", "8 G"}) {
    EXPECT_EQ(byte_count_from(text), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace raycone::test
