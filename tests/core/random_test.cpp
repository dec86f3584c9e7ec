#include "core/sampling/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include "tests/support/statistics.h"

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

// SplitMix64 (Steele, Lea, Flood 2014), from the paper.
class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t seed) : state_(seed) {}
  std::uint64_t operator()() {
    state_ += 0x9e3779b97f4a7c15;
    std::uint64_t z = state_;
    z ^= z >> 30;
    z *= 0xbf58476d1ce4e5b9;
    z ^= z >> 27;
    z *= 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }

 private:
  std::uint64_t state_;
};

// As published with Vigna's and Java's implementations.
TEST(Random, TheReferenceIsSplitMix64) {
  SplitMix64 zero(0), other(1234567);
  for (const std::uint64_t expected :
       {0xe220a8397b1dcdafU, 0x6e789e6aa1b965f4U, 0x06c45d188009454fU, 0xf88bb8a8724c81ecU}) {
    EXPECT_EQ(zero(), expected);
  }
  for (const std::uint64_t expected : {6457827717110365317U, 3203168211198807973U, 9817491932198370423U,
                                       4593380528125082431U, 16408922859458223821U}) {
    EXPECT_EQ(other(), expected);
  }
}

// A stream is SplitMix64 from a state that is itself an output: of SplitMix64 `stream` steps after one of the seed's.
TEST(Random, StreamsAreThoseOfSplitMix64) {
  constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15, kMost = ~std::uint64_t{0};
  for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{1} << 63, kMost}) {
    for (const std::uint64_t stream : {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{1} << 48, kMost}) {
      SplitMix64 of_seed(seed);
      SplitMix64 of_streams(of_seed() + (stream - 1) * kStep);
      SplitMix64 expected(of_streams());
      Random random(seed, stream);
      for (int i = 0; i < 20; ++i) ASSERT_EQ(random.bits(), expected()) << seed << ' ' << stream;
    }
  }
}

// Marsaglia's polar method with the C library's logarithm in 64 bits.
TEST(Random, NormalNumbersAreThoseOfThePolarMethod) {
  for (std::uint64_t stream = 0; stream < 20000; ++stream) {
    Random random(5, stream), numbers(5, stream);
    long double u = 0, v = 0, square = 0;
    do {
      u = 2 * static_cast<long double>(numbers.uniform()) - 1;
      v = 2 * static_cast<long double>(numbers.uniform()) - 1;
      square = u * u + v * v;
    } while (square >= 1 || square == 0);
    const long double factor = std::sqrt(-2 * std::log(square) / square);
    for (const long double expected : {u * factor, v * factor}) {
      // 6 u: of the square (1.5), the logarithm (3, next to 1 where the square's error counts most), quotient, root.
      const double number = random.normal();
      ASSERT_NEAR(number, static_cast<double>(expected),
                  6 * 0x1p-53 * std::abs(static_cast<double>(expected)) / static_cast<double>(1 - square));
      ASSERT_LT(std::abs(number), Random::kLargestNormal);
    }
  }
}

// Points of one file have numbers of neighbouring streams, coordinates those that follow each other.
TEST(Random, NeighbouringNumbersAreIndependent) {
  constexpr std::size_t kSide = 16;
  std::vector<std::size_t> streams(kSide * kSide, 0), places(kSide * kSide, 0), seeds(kSide * kSide, 0);
  const auto cell = [](double a, double b) {
    return static_cast<std::size_t>(a * kSide) * kSide + static_cast<std::size_t>(b * kSide);
  };
  for (std::uint64_t n = 0; n < 100000; ++n) {
    Random one(9, n), next(9, n + 1), other(10, n);
    const double first = one.uniform();
    ++streams[cell(first, next.uniform())];
    ++seeds[cell(first, other.uniform())];
    ++places[cell(first, one.uniform())];
  }
  EXPECT_LE(test::chi_squared(streams), 1);
  EXPECT_LE(test::chi_squared(seeds), 1);
  EXPECT_LE(test::chi_squared(places), 1);
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
