#include "core/orientation/sign_problem.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "core/machine/threads.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

// With twice as many samples, on which each surface acts.
std::pair<SignProblem, std::vector<double>> random_problem(test::Random& random, std::size_t count) {
  const std::size_t samples = 2 * count;
  SignProblem problem(std::vector<double>(samples, 1.0));
  for (std::size_t p = 0; p < count; ++p) {
    std::vector<SignProblem::Effect> effects;
    for (std::uint32_t k = 0; k < samples; ++k) {
      effects.push_back({k, static_cast<float>(test::uniform(random, -1.0, 1.0))});
    }
    problem.add_surface(effects);
  }
  std::vector<double> rest;
  for (std::size_t k = 0; k < samples; ++k) rest.push_back(test::uniform(random, -1.0, 1.0));
  return {std::move(problem), std::move(rest)};
}

// By the bits of a number.
std::vector<int> signs_of(unsigned number, std::size_t count) {
  std::vector<int> signs;
  for (std::size_t p = 0; p < count; ++p) signs.push_back((number >> p & 1U) != 0 ? -1 : 1);
  return signs;
}

// Heavy samples keep two surfaces alike; a light one asks for both to be turned. Turning either alone is worse.
TEST(SignProblem, TurnsTwoSurfacesAtOnceWhereOneDoesNotHelp) {
  SignProblem problem({100.0, 1.0});
  problem.add_surface(std::vector<SignProblem::Effect>{{0, 1.0F}, {1, 0.125F}});
  problem.add_surface(std::vector<SignProblem::Effect>{{0, -1.0F}, {1, 0.125F}});
  const std::vector<double> rest{0.0, 0.5};
  std::vector<int> sign{1, 1};
  EXPECT_EQ(problem.sum(rest, sign), 0.75 * 0.75);
  EXPECT_EQ(problem.improve(rest, sign), 0.25 * 0.25);
  EXPECT_EQ(sign, std::vector<int>({-1, -1}));
}

// Of up to ten surfaces, against all signs.
TEST(SignProblem, FindsTheLeastSumOfAFewSurfaces) {
  test::Random random(1);
  for (int round = 0; round < 200; ++round) {
    const auto count = static_cast<std::size_t>(1 + round % 10);
    auto [problem, rest] = random_problem(random, count);
    double least = std::numeric_limits<double>::infinity();
    for (unsigned signs = 0; signs < 1U << count; ++signs) {
      least = std::min(least, problem.sum(rest, signs_of(signs, count)));
    }
    std::vector<int> sign(count, 1);
    EXPECT_LT(problem.improve(rest, sign), least + 1e-12) << round;  // roundings of a hundred terms below 100
  }
}

TEST(SignProblem, TellsTheSumOfItsSignsForAnyNumberOfThreads) {
  constexpr std::size_t kCount = 100;
  const auto with = [&](int threads) {
    const ThreadLimit limit(threads);
    test::Random random(2);
    auto [problem, rest] = random_problem(random, kCount);
    std::vector<int> sign(kCount, 1);
    const double before = problem.sum(rest, sign), sum = problem.improve(rest, sign);
    EXPECT_EQ(problem.sum(rest, sign), sum);
    EXPECT_LT(sum, before);
    return sign;
  };
  EXPECT_EQ(with(1), with(2));
  EXPECT_EQ(with(1), with(5));
}

TEST(SignProblem, TurnsSingleSurfacesOfMany) {
  constexpr std::size_t kMany = 600;  // of which products are not made
  SignProblem problem(std::vector<double>(kMany, 1.0));
  for (std::uint32_t n = 0; n < kMany; ++n) problem.add_surface(std::vector<SignProblem::Effect>{{n, 0.5F}});
  const std::vector<double> rest(kMany, -0.5);
  std::vector<int> sign(kMany, -1);
  EXPECT_EQ(problem.sum(rest, sign), kMany);
  EXPECT_EQ(problem.improve(rest, sign), 0.0);
  EXPECT_EQ(sign, std::vector<int>(kMany, 1));
}

}  // namespace
}  // namespace raycone
