#include "core/orientation/sign_problem.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace raycone {
namespace {

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

TEST(SignProblem, TurnsSingleSurfacesOfMany) {
  constexpr std::size_t kMany = 200;  // of which no pairs are tried
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
