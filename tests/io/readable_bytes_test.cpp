#include "io/files/readable_bytes.h"

#include <gtest/gtest.h>

namespace raycone::test {
namespace {

TEST(ReadableBytes, UsesTheUnitsOfTheOptions) {
  EXPECT_EQ(readable_bytes(0), "0 bytes");
  EXPECT_EQ(readable_bytes(1024), "1 kB");
  EXPECT_EQ(readable_bytes(1.5 * 1024 * 1024), "1.5 MB");
  EXPECT_EQ(readable_bytes(34.0 * (1 << 30)), "34 GB");
}

}  // namespace
}  // namespace raycone::test
