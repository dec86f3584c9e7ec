// "Const calls may run concurrently": all of them, on one evaluator that has built nothing yet, by any engine.
#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/data/rule.h"
#include "core/evaluation/winding_number.h"
#include "core/machine/threads.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

constexpr double kCritical = 0.3;  // no half-integer, which values are right about by themselves

// All that is asked of an evaluator at once, as numbers.
class Questions {
 public:
  Questions() {
    test::Random random(1);
    for (Vec3& p : points_) p = test::uniform_point(random, {{-1.1, -1.1, -1.1}, {1.1, 1.1, 1.1}});
  }

  static constexpr std::size_t kCount = 5;

  [[nodiscard]] std::vector<double> ask(const WindingNumberEvaluator& evaluator, std::size_t question) const {
    std::vector<double> values(question < 2 ? block_.size() : points_.size());
    if (question == 0) evaluator.evaluate(lattice_, block_, values);
    if (question == 1) {
      std::vector<std::uint8_t> sides(values.size());
      evaluator.evaluate_sides({RuleKind::kThreshold, kCritical}, lattice_, block_, sides);
      values.assign(sides.begin(), sides.end());
    }
    if (question == 2) evaluator.evaluate(points_, values);
    if (question == 3) evaluator.evaluate_unsettled(points_, values);
    if (question == 4) {
      evaluator.evaluate(points_, values);
      evaluator.settle(points_, kCritical, values);
    }
    return values;
  }

 private:
  std::vector<Vec3> points_ = std::vector<Vec3>(300);
  Lattice lattice_{{-1.1, -1.1, -1.1}, {0.1, 0.1, 0.1}, {0, 0, 0}, {22, 22, 22}};
  LatticeBlock block_ = whole(lattice_);
};

class Concurrently : public testing::TestWithParam<Summation> {};

TEST_P(Concurrently, ConstCallsGiveWhatTheyGiveOneByOne) {
  const TriangleMesh mesh = test::sieve(24, 5);
  const EvaluatorOptions options{.summation = GetParam(), .accuracy = {.tolerance = 1e-6, .points = 300}};
  const Questions questions;
  std::vector<std::vector<double>> expected;
  for (std::size_t question = 0; question < Questions::kCount; ++question) {
    expected.push_back(questions.ask(WindingNumberEvaluator(mesh, options), question));
  }
  ASSERT_NE(expected[0], std::vector<double>(expected[0].size())) << "else nothing would be compared";
  for (int repetition = 0; repetition < 3; ++repetition) {
    const ThreadLimit limit(8);
    const WindingNumberEvaluator evaluator(mesh, options);
    std::atomic<int> wrong{0};
    parallel_for(4 * Questions::kCount, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        const std::size_t question = (n + static_cast<std::size_t>(repetition)) % Questions::kCount;
        wrong += questions.ask(evaluator, question) != expected[question];
      }
    });
    EXPECT_EQ(wrong, 0);
    const WindingNumberEvaluator::Estimate estimate = evaluator.estimated_seconds({{}, {1, 1, 1}, {}, {8, 8, 8}});
    EXPECT_GT(estimate.seconds, 0.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Engines, Concurrently,
                         testing::Values(Summation::kCheapest, Summation::kCone, Summation::kTriangles,
                                         Summation::kFarField, Summation::kBlocks),
                         [](const auto& engine) { return std::to_string(static_cast<int>(engine.param)); });

// Larger lattices take longer, and what would take seconds to estimate is a limit.
TEST(EstimatedSeconds, GrowWithTheLattice) {
  const auto seconds = [](const TriangleMesh& mesh, std::int64_t side) {
    const double spacing = 2.0 / static_cast<double>(side);
    const Lattice lattice{{-1, -1, -1}, {spacing, spacing, spacing}, {0, 0, 0}, {side, side, side}};
    const WindingNumberEvaluator::Estimate estimate = WindingNumberEvaluator(mesh).estimated_seconds(lattice);
    EXPECT_FALSE(estimate.at_most);
    return estimate.seconds;
  };
  for (const TriangleMesh& mesh : {test::sieve(24, 5), test::open_box(), test::sphere(10)}) {
    EXPECT_GT(seconds(mesh, 100), 0.0);
    EXPECT_LT(seconds(mesh, 400), 3600.0);
    // 64 times the samples; what is prepared, and the noise of a millisecond's timing, are in both.
    EXPECT_GT(seconds(mesh, 400), 4 * seconds(mesh, 100));
  }
}

}  // namespace
}  // namespace raycone
