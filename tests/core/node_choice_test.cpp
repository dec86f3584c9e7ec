#include "core/evaluation/node_choice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/lattice_rows.h"

namespace raycone {
namespace {

const SampleBox kBox{{0, 0, 0}, {24, 12, 12}};

LatticeRows unit_rows() { return test::rows_of({{0, 0, 0}, {1, 1, 1}, {0, 0, 0}, {24, 12, 12}}); }

// Those of 1 / distance at this distance.
std::vector<double> derivatives_at(double distance) {
  std::vector<double> all;
  for (int k = 1; k <= 8; ++k) all.push_back(std::pow(1 / distance, k + 1));
  return all;
}

TEST(ChooseNodes, TakesFewNodesWhereTheFunctionIsSmooth) {
  std::size_t before = kBox.size();
  for (const double distance : {15.0, 40.0, 200.0}) {
    const std::vector<double> derivatives = derivatives_at(distance);
    const auto grid = choose_nodes(unit_rows(), kBox, derivatives, 20 * derivatives[0]);
    ASSERT_TRUE(grid) << distance;
    EXPECT_LT(grid->size(), before);
    EXPECT_LE(grid->bend(), 0.04);
    before = grid->size();
  }
}

TEST(ChooseNodes, GivesUpWhereItIsNot) {
  EXPECT_FALSE(choose_nodes(unit_rows(), kBox, derivatives_at(1.0), 20.0));
  EXPECT_FALSE(choose_nodes(unit_rows(), kBox, std::vector<double>(8, INFINITY), INFINITY));
}

// Where bends leave all samples undecided, nodes serve nobody.
TEST(ChooseNodes, GivesUpWhereNothingWouldBeDecided) {
  EXPECT_FALSE(choose_nodes(unit_rows(), kBox, derivatives_at(15.0), 1e-9));
}

}  // namespace
}  // namespace raycone
