#include "app/process/default_threads.h"

#include <gtest/gtest.h>

namespace raycone::test {
namespace {

TEST(DefaultThreads, AreSensibleOnThisMachine) {
  EXPECT_GE(default_threads(), 1);
  EXPECT_LE(default_threads(), kMaxThreads);
}

}  // namespace
}  // namespace raycone::test
