#include "core/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace raycone {
namespace {

// Files of samples rely on these: a seed means the same points in every version and on every machine.
TEST(Random, NumbersArePinned) {
  Random random(1, 0);
  EXPECT_EQ(random.bits(), 7982734928498899980U);
  EXPECT_EQ(random.uniform(), 0.4256321780286294);
  EXPECT_EQ(random.normal(), 0.16593460708419905);
  EXPECT_EQ(random.normal(), 1.3270651066541646);
  EXPECT_EQ(Random(42, 1000000).bits(), 4114009056800554693U);
}

TEST(Random, StreamsAndSeedsDiffer) {
  std::set<std::uint64_t> first;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    for (std::uint64_t stream = 0; stream < 30; ++stream) first.insert(Random(seed, stream).bits());
  }
  EXPECT_EQ(first.size(), 900U);
}

TEST(Random, UniformNumbersFillTheInterval) {
  constexpr int kCount = 200000;
  double sum = 0.0, squares = 0.0, least = 1.0, most = 0.0;
  for (int n = 0; n < kCount; ++n) {
    const double x = Random(7, static_cast<std::uint64_t>(n)).uniform();  // across streams, as they are used
    sum += x;
    squares += x * x;
    least = std::min(least, x);
    most = std::max(most, x);
  }
  // Standard deviations of the mean: 0.29 / sqrt(n) = 6.5e-4, of the squares' 0.3 / sqrt(n); five of them.
  EXPECT_NEAR(sum / kCount, 0.5, 3.3e-3);
  EXPECT_NEAR(squares / kCount, 1.0 / 3, 3.4e-3);
  EXPECT_GE(least, 0.0);
  EXPECT_LT(most, 1.0);
  EXPECT_GT(most - least, 0.9998);
}

TEST(Random, NormalNumbersHaveNormalMomentsAndTails) {
  constexpr int kCount = 300000;
  double sum = 0.0, squares = 0.0, fourth = 0.0;
  int beyond_one = 0, beyond_three = 0;
  for (int n = 0; n < kCount / 3; ++n) {
    Random random(3, static_cast<std::uint64_t>(n));
    for (int i = 0; i < 3; ++i) {
      const double x = random.normal();
      sum += x;
      squares += x * x;
      fourth += x * x * x * x;
      beyond_one += std::abs(x) > 1;
      beyond_three += std::abs(x) > 3;
    }
  }
  // Five standard deviations of each mean: 5 sqrt(Var / n), Var = 1, 2, 96; of the shares p: 5 sqrt(p / n) at most.
  EXPECT_NEAR(sum / kCount, 0.0, 9.2e-3);
  EXPECT_NEAR(squares / kCount, 1.0, 1.3e-2);
  EXPECT_NEAR(fourth / kCount, 3.0, 9e-2);
  EXPECT_NEAR(static_cast<double>(beyond_one) / kCount, 0.31731, 5e-3);
  EXPECT_NEAR(static_cast<double>(beyond_three) / kCount, 0.0026998, 5e-4);
}

}  // namespace
}  // namespace raycone
