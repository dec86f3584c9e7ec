#include "core/boundary/edge_time.h"

#include <gtest/gtest.h>

#include "core/machine/floating_point.h"

namespace raycone {
namespace {

// No machine does dozens of operations in 10 picoseconds, or needs a microsecond for them. Measured once.
TEST(EdgeTime, IsThatOfSomeDozenOperations) {
  const DefaultFloatingPoint guard;
  const double seconds = edge_seconds(SimdLevel::kBest);
  EXPECT_GT(seconds, 1e-11);
  EXPECT_LT(seconds, 1e-6);
  EXPECT_EQ(edge_seconds(SimdLevel::kBest), seconds);
}

}  // namespace
}  // namespace raycone
