#include "io/fields/narrowing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/data/rule.h"
#include "io/files/half.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::Random;

FieldDescription winding_of(const Rule& rule) {
  FieldDescription field;
  field.threshold = rule.threshold;
  field.threshold_of_magnitude = rule.kind == RuleKind::kAbs;
  return field;
}

// Values about each number where a rule may change its mind: within some steps of double, and of float.
std::vector<double> values_about(const std::vector<double>& numbers) {
  std::vector<double> values;
  for (const double number : numbers) {
    for (const double sign : {1.0, -1.0}) {
      double up = sign * number, down = sign * number;
      for (int step = 0; step < 3; ++step) {
        values.insert(values.end(), {up, down});
        up = std::nextafter(up, HUGE_VAL);
        down = std::nextafter(down, -HUGE_VAL);
      }
      for (const double by : {1e-15, 1e-12, 1e-9, 1e-8, 5.9e-8, 6e-8, 1.2e-7, 1e-6, 2.4e-4, 4.9e-4, 1e-3}) {
        values.insert(values.end(), {sign * number + by, sign * number - by});
      }
    }
  }
  return values;
}

const std::vector<Rule> kRules = {
    {},
    {RuleKind::kThreshold, 0.3},
    {RuleKind::kThreshold, 0.7},
    {RuleKind::kThreshold, -0.1},
    {RuleKind::kThreshold, 0.0},
    {RuleKind::kThreshold, 1.0},
    {RuleKind::kThreshold, 1.0 / 3},
    {RuleKind::kThreshold, 1e-30},
    {RuleKind::kAbs, 0.3},
    {RuleKind::kAbs, 0.7},
    {RuleKind::kAbs, 0.5},
    {RuleKind::kNonzero, 0.5},
    {RuleKind::kPositive, 0.5},
    {RuleKind::kOdd, 0.5},
};
const std::vector<double> kCritical = {0.5, 1.5, 2.5, 7.5, 0.3, 0.7, 0.1, 0.0, 1.0, 1.0 / 3, 1e-30};

// As readers compare: a float with the threshold as double, or as float.
bool holds_as_float(const Rule& rule, float value) {
  return holds({rule.kind, static_cast<double>(static_cast<float>(rule.threshold))}, value);
}

TEST(Narrowing, ChangesNoRulesMind) {
  Random random(1);
  std::vector<double> values = values_about(kCritical);
  for (int n = 0; n < 2000; ++n) values.push_back(test::uniform(random, -4, 4));
  int moved = 0;
  for (const Rule& rule : kRules) {
    const Narrowing narrowing(winding_of(rule));
    for (const double value : values) {
      const float stored = narrowing(value);
      EXPECT_EQ(holds(rule, static_cast<double>(stored)), holds(rule, value)) << value << " as " << stored;
      EXPECT_EQ(holds_as_float(rule, stored), holds(rule, value)) << value << " as " << stored;
      EXPECT_LE(std::abs(static_cast<double>(stored) - value), 2e-7 * std::max(1.0, std::abs(value)));
      moved += stored != static_cast<float>(value);
    }
  }
  EXPECT_GT(moved, 100);  // the nearest float would have been wrong
}

TEST(Narrowing, IsTheNearestFloatElsewhere) {
  Random random(2);
  const Narrowing narrowing(winding_of({}));
  for (int n = 0; n < 10000; ++n) {
    const double value = test::uniform(random, -0.49, 0.49);
    EXPECT_EQ(narrowing(value), static_cast<float>(value));
  }
  for (const double value : {0.5, -0.5, 1.0, 0.0, 12.5, 0x1p100, -0x1p60 - 0.5}) {
    EXPECT_EQ(narrowing(value), static_cast<float>(value));
  }
}

TEST(Narrowing, LeavesOtherFieldsAlone) {
  FieldDescription field = winding_of({});
  for (const FieldKind kind : {FieldKind::kDistance, FieldKind::kCount}) {
    field.kind = kind;
    const double below = std::nextafter(0.5, 0.0);
    EXPECT_EQ(Narrowing(field)(below), 0.5F);
  }
}

TEST(Narrowing, KeepsNegativeDistancesNegative) {
  FieldDescription field;
  field.kind = FieldKind::kDistance;
  const Narrowing narrowing(field);
  for (const double tiny : {1e-40, 1e-46, 1e-50, 1e-300, 5e-324}) {
    EXPECT_LT(narrowing(-tiny), 0.0F) << tiny;
    EXPECT_GE(narrowing(-tiny), -std::max(static_cast<float>(1.01 * tiny), 1.5e-45F)) << tiny;
    EXPECT_GE(narrowing(tiny), 0.0F) << tiny;
  }
  EXPECT_EQ(narrowing(-0.0), 0.0F);
  EXPECT_EQ(narrowing(-0.3), -0.3F);
}

// docs/formats.md: winding numbers beyond 65504 become that with f16.
TEST(Narrowing, StopsAtTheLargestHalf) {
  for (const double threshold : {65503.7, 65504.0, 65504.5, 70000.0, 131008.0, 140000.0, 1e12}) {
    for (const Rule& rule : {Rule{RuleKind::kThreshold, threshold}, Rule{RuleKind::kThreshold, -threshold},
                             Rule{RuleKind::kAbs, threshold}}) {
      const Narrowing narrowing(winding_of(rule), Digits::kHalf);
      for (const double value : values_about({1.0, 65504.0, 65504.5, 70000.0, 131008.0, 140000.0, 1e12})) {
        const double stored = narrowing(value);
        ASSERT_TRUE(std::abs(stored) <= kLargestHalf) << value << " for " << threshold;
        EXPECT_LE(std::abs(stored - std::clamp(value, -kLargestHalf, kLargestHalf)), 32)
            << value << " for " << threshold;
        if (std::abs(value) > kLargestHalf + 1 && std::abs(threshold) > kLargestHalf) {
          EXPECT_EQ(stored, std::copysign(kLargestHalf, value)) << value << " for " << threshold;
        }
      }
    }
  }
}

TEST(Narrowing, RoundsBoundsUp) {
  Random random(4);
  FieldDescription field;
  field.kind = FieldKind::kBound;
  const Narrowing narrowing(field);
  int moved = 0;
  for (int n = 0; n < 1000; ++n) {
    const double bound = std::ldexp(test::uniform(random, 0.5, 1), -n);
    const float stored = narrowing(bound);
    EXPECT_GE(static_cast<double>(stored), bound);
    EXPECT_LT(static_cast<double>(std::nextafter(stored, 0.0F)), bound);
    moved += stored != static_cast<float>(bound);
  }
  EXPECT_GT(moved, 100);  // the nearest float would have been no bound
  EXPECT_EQ(narrowing(0.0), 0.0F);
  EXPECT_EQ(narrowing(0x1p-50), 0x1p-50F);
}

TEST(Narrowing, ChangesNoRulesMindAsHalf) {
  for (const Rule& rule : kRules) {
    if (rule.threshold == 1e-30) continue;  // beyond their range
    const Narrowing narrowing(winding_of(rule), Digits::kHalf);
    for (const double value : values_about({0.5, 1.5, 2.5, 7.5, 0.3, 0.7, 1.0, 1.0 / 3})) {
      const float stored = narrowing(value);
      EXPECT_EQ(nearest_half(stored), stored);
      EXPECT_EQ(holds(rule, static_cast<double>(stored)), holds(rule, value)) << value << " as " << stored;
      const Rule as_short{rule.kind, static_cast<double>(nearest_half(rule.threshold))};  // as NumPy compares halves
      EXPECT_EQ(holds(as_short, static_cast<double>(stored)), holds(rule, value)) << value << " as " << stored;
      EXPECT_LE(std::abs(static_cast<double>(stored) - value), 2e-3 * std::max(1.0, std::abs(value)));
    }
  }
}

// Pieces without a number that needs care, with one, and with many take different ways.
TEST(Narrowing, StoresManyAsOneByOne) {
  Random random(5);
  std::vector<double> values(600, 0.0);
  const std::vector<double> critical = values_about(kCritical);
  values.insert(values.end(), critical.begin(), critical.end());
  for (int n = 0; n < 3000; ++n) values.push_back(test::uniform(random, -4, 4));
  values.insert(values.end(), {-0.0, 1e-320, -1e-320, 1e-60, -1e-60, 1e5, -1e5, 2049.5, -2049.5});
  for (int n = 0; n < 500; ++n) values.push_back(std::ldexp(test::uniform(random, -1, 1), -n));
  int cares = 0;
  for (const FieldKind kind :
       {FieldKind::kReal, FieldKind::kDensity, FieldKind::kDistance, FieldKind::kBound, FieldKind::kVector}) {
    for (const Digits digits : {Digits::kSingle, Digits::kHalf}) {
      for (const Rule& rule : kRules) {
        FieldDescription field = winding_of(rule);
        field.kind = kind;
        const Narrowing narrowing(field, digits);
        std::vector<float> stored(values.size());
        narrowing.store(values, stored.data());
        for (std::size_t n = 0; n < values.size(); ++n) {
          ASSERT_EQ(stored[n], narrowing(values[n])) << values[n];
          ASSERT_FALSE(stored[n] == 0.0F && std::signbit(stored[n])) << values[n];
          cares += stored[n] != (digits == Digits::kHalf ? nearest_half(values[n]) : static_cast<float>(values[n]));
        }
      }
    }
  }
  EXPECT_GT(cares, 1000);
}

}  // namespace
}  // namespace raycone
