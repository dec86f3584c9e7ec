// Names of fields and rules, and what follows from winding numbers.
#include "app/fields/fields.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace raycone::test {
namespace {

TEST(RuleNames, AreThoseOfTheCommandLine) {
  for (const char* const name : {"threshold=0.5", "threshold=-2", "abs=0.25", "nonzero", "positive", "odd"}) {
    const std::optional<Rule> rule = rule_from_name(name);
    ASSERT_TRUE(rule) << name;
    EXPECT_EQ(name_of(*rule), name);
  }
  EXPECT_EQ(name_of(*rule_from_name("threshold=5e-1")), "threshold=0.5");
  for (const char* const name :
       {"", "threshold", "threshold=", "threshold=nan", "abs=1e999", "abs=1x", "even", "ODD"}) {
    EXPECT_FALSE(rule_from_name(name)) << name;
  }
}

std::vector<std::string> names_of(const std::vector<FieldDescription>& fields) {
  std::vector<std::string> names;
  for (const FieldDescription& field : fields) names.push_back(field.name);
  return names;
}

TEST(DescribeFields, ListsFieldsAsAskedForThenDiagnostics) {
  FieldOptions options;
  options.fields = {Field::kDensity, Field::kWinding, Field::kInside};
  EXPECT_EQ(names_of(describe_fields(options, 0.0)), (std::vector<std::string>{"density", "winding", "inside"}));
  options.diagnostics = true;
  EXPECT_EQ(names_of(describe_fields(options, 0.0)),
            (std::vector<std::string>{"density", "winding", "inside", "crossings", "degenerate", "on_surface",
                                      "error_bound"}));
}

TEST(DescribeFields, TheBackgroundOfInsideIsTheRuleFarAway) {
  FieldOptions options;
  options.fields = {Field::kInside};
  EXPECT_EQ(describe_fields(options, 0.0).front().background, 0.0);
  options.rule = {RuleKind::kThreshold, 0.0};
  EXPECT_EQ(describe_fields(options, 0.0).front().background, 1.0);
}

TEST(FieldSamples, DeriveFieldsFromWindingNumbers) {
  FieldOptions options;
  options.fields = {Field::kDensity, Field::kInside, Field::kWinding};
  options.rule = {RuleKind::kAbs, 1.0};
  FieldSamples samples(options);
  samples.resize(4, FieldSamples::From::kWindingNumbers);
  const std::vector<double> w{-1.5, 0.25, 1.0, 7.0};
  std::ranges::copy(w, samples.winding_numbers().begin());
  samples.derive();
  const auto fields = samples.fields();
  ASSERT_EQ(fields.size(), 3U);
  const auto density = std::get<std::span<const double>>(fields[0]);
  const auto inside = std::get<std::span<const std::uint8_t>>(fields[1]);
  const auto winding = std::get<std::span<const double>>(fields[2]);
  EXPECT_TRUE(std::ranges::equal(density, std::vector<double>{0.0, 0.25, 1.0, 1.0}));
  EXPECT_TRUE(std::ranges::equal(inside, std::vector<int>{1, 0, 1, 1}));
  EXPECT_TRUE(std::ranges::equal(winding, w));
}

TEST(FieldSamples, DeriveFieldsFromSides) {
  FieldOptions options;
  options.fields = {Field::kDistance, Field::kInside};
  FieldSamples samples(options);
  samples.resize(3, FieldSamples::From::kSides);
  EXPECT_TRUE(samples.winding_numbers().empty());
  std::ranges::copy(std::vector<std::uint8_t>{0, 1, 1}, samples.sides().begin());
  std::ranges::copy(std::vector{0.5, 0.25, 0.0}, samples.distances().begin());
  samples.derive();
  EXPECT_TRUE(std::ranges::equal(samples.numbers().distance, std::vector{0.5, -0.25, 0.0}));
  EXPECT_TRUE(std::ranges::equal(samples.numbers().inside, std::vector<int>{0, 1, 1}));
  EXPECT_TRUE(std::ranges::equal(samples.shown(), std::vector{0.0, 1.0, 1.0}));
}

}  // namespace
}  // namespace raycone::test
