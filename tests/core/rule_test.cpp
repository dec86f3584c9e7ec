#include "core/data/rule.h"

#include <gtest/gtest.h>

#include <cmath>

namespace raycone {
namespace {

TEST(Rule, IsAHalfOrMoreByDefault) {
  EXPECT_TRUE(holds({}, 0.5));
  EXPECT_TRUE(holds({}, 7.0));
  EXPECT_FALSE(holds({}, std::nextafter(0.5, 0.0)));
  EXPECT_FALSE(holds({}, -1.0));
}

TEST(Rule, ThresholdIncludesTheThreshold) {
  const Rule rule{RuleKind::kThreshold, -1.25};
  EXPECT_TRUE(holds(rule, -1.25));
  EXPECT_TRUE(holds(rule, 0.0));
  EXPECT_FALSE(holds(rule, std::nextafter(-1.25, -2.0)));
}

TEST(Rule, AbsTakesEitherSign) {
  const Rule rule{RuleKind::kAbs, 0.75};
  EXPECT_TRUE(holds(rule, 0.75));
  EXPECT_TRUE(holds(rule, -0.75));
  EXPECT_FALSE(holds(rule, std::nextafter(-0.75, 0.0)));
}

// floor(w + 1/2), also where w + 1/2 is no double.
TEST(Rule, IntegerRulesRoundExactly) {
  const Rule nonzero{RuleKind::kNonzero, 0.5};
  EXPECT_FALSE(holds(nonzero, std::nextafter(0.5, 0.0)));
  EXPECT_TRUE(holds(nonzero, 0.5));
  EXPECT_FALSE(holds(nonzero, -0.5)) << "half a turn backwards rounds up, to 0";
  EXPECT_TRUE(holds(nonzero, std::nextafter(-0.5, -1.0)));
  EXPECT_FALSE(holds(nonzero, -1e-300));
}

TEST(Rule, PositiveAndOddLookAtTheInteger) {
  const Rule positive{RuleKind::kPositive, 0.5}, odd{RuleKind::kOdd, 0.5};
  EXPECT_TRUE(holds(positive, 0.5));
  EXPECT_FALSE(holds(positive, 0.49));
  EXPECT_FALSE(holds(positive, -2.0));
  EXPECT_TRUE(holds(odd, 1.0));
  EXPECT_TRUE(holds(odd, -1.0));
  EXPECT_TRUE(holds(odd, 3.4));
  EXPECT_FALSE(holds(odd, 2.0));
  EXPECT_FALSE(holds(odd, -2.2));
  EXPECT_FALSE(holds(odd, 0.0));
}

}  // namespace
}  // namespace raycone
