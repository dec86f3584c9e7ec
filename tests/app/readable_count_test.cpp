#include "app/text/readable_count.h"

#include <gtest/gtest.h>

namespace raycone {
namespace {

TEST(ReadableCount, HasThreeDigitsAndAPrefix) {
  EXPECT_EQ(readable_count(0.0), "0");
  EXPECT_EQ(readable_count(999.4), "999");
  EXPECT_EQ(readable_count(999.6), "1 k") << "not 1e+03";
  EXPECT_EQ(readable_count(12345.0, "samples/s"), "12.3 ksamples/s");
  EXPECT_EQ(readable_count(0.5, "meshes/s"), "0.5 meshes/s");
  EXPECT_EQ(readable_count(2e12), "2e+03 G");
}

}  // namespace
}  // namespace raycone
