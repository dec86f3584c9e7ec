#include "io/files/counted.h"

#include <gtest/gtest.h>

namespace raycone::test {
namespace {

TEST(Counted, AgreesWithItsNoun) {
  EXPECT_EQ(counted(1, "byte"), "1 byte");
  EXPECT_EQ(counted(0, "byte"), "0 bytes");
  EXPECT_EQ(counted(18446744073709551615U, "face"), "18446744073709551615 faces");
  EXPECT_EQ(counted(1, "vertex"), "1 vertex");
  EXPECT_EQ(counted(3, "vertex"), "3 vertices");
  EXPECT_EQ(counted(2, "mesh"), "2 meshes");
}

}  // namespace
}  // namespace raycone::test
