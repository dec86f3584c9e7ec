// A short, seeded run of the generated cases; raycone_stress runs them for hours.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "tests/property/cases.h"
#include "tests/property/check.h"
#include "tests/property/check_samples.h"

namespace raycone::test {
namespace {

class Property : public testing::TestWithParam<std::size_t> {};

constexpr std::uint64_t kMeshes = 12;  // of each family

TEST_P(Property, HoldsForGeneratedMeshes) {
  CheckCounts counts;
  for (std::uint64_t seed = 1; seed <= kMeshes; ++seed) {
    const Case c = make_case(GetParam(), seed);
    const auto failure = check(c.mesh, c.queries, &counts);
    ASSERT_FALSE(failure) << "seed " << seed << "\n" << describe(shrink(c.mesh, failure->query), *failure);
  }
  EXPECT_GT(counts.degenerate, 40U);  // else the generator has lost its point
  EXPECT_EQ(counts.values, kMeshes * 64);
  EXPECT_LT(counts.undecided, kMeshes * 64 / 50);  // else a fiftieth of the values has been compared with nothing
}

TEST_P(Property, PointsDrawnFromGeneratedMeshesLieOnThem) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Case c = make_case(GetParam(), seed);
    const auto failure = check_samples(c.mesh, seed, 10);
    ASSERT_FALSE(failure) << "seed " << seed << "\n" << describe(c.mesh, *failure);
  }
}

// At halves, integers and their neighbours, and anywhere.
TEST(PropertyOfRules, HoldAsTheirDefinitionsSay) {
  for (int n = -40; n <= 40; ++n) {
    const double half = 0.5 * n;
    for (const double w : {half, std::nextafter(half, 99), std::nextafter(half, -99), half + 0x1p-40, half - 0x1p-30}) {
      const auto wrong_rule = check_rules(w);
      ASSERT_FALSE(wrong_rule) << *wrong_rule << " at " << w;
    }
  }
  for (const double w : {5e-324, 0x1p-1000, 1e15 + 0.5, 0x1p52 + 1, 0x1p53, 0x1p53 + 2, 1e300}) {
    for (const double signed_w : {w, -w}) {
      const auto wrong_rule = check_rules(signed_w);
      ASSERT_FALSE(wrong_rule) << *wrong_rule << " at " << w;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Families, Property, testing::Range(std::size_t{0}, family_count()),
                         [](const auto& family) { return std::to_string(family.param); });

// Negative controls: whatever is wrong with right answers, on every family, is noticed.
class PropertyCheck : public testing::Test {
 protected:
  using Damage = std::function<void(Answers&)>;

  struct Evaluated {
    TriangleMesh mesh;
    std::vector<Answers> answers;  // right ones
  };

  // A few queries of each family.
  static const std::vector<Evaluated>& evaluated() {
    static const std::vector<Evaluated> all = [] {
      constexpr std::size_t kQueries = 12;
      std::vector<Evaluated> evaluated;
      for (std::size_t family = 0; family < family_count(); ++family) {
        Case c = make_case(family, 1);
        c.queries.resize(kQueries);
        std::vector<Answers> answers = answers_of(c.mesh, c.queries);
        std::erase_if(answers, [&](const Answers& one) {
          CheckCounts counts;
          EXPECT_FALSE(wrong(c.mesh, one, counts));
          return counts.undecided > 0;
        });
        evaluated.push_back({c.mesh, answers});
      }
      return evaluated;
    }();
    return all;
  }

  // Of the answers that `applies` to, how many pass for right after the damage.
  static std::size_t unnoticed(const Damage& damage, const std::function<bool(const Answers&)>& applies = {}) {
    std::size_t damaged = 0, unnoticed = 0;
    for (const auto& [mesh, all] : evaluated()) {
      for (Answers answers : all) {
        if (applies && !applies(answers)) continue;
        damage(answers);
        ++damaged;
        CheckCounts counts;
        unnoticed += !wrong(mesh, answers, counts);
      }
    }
    EXPECT_GE(damaged, 10U);
    return unnoticed;
  }
  static Damage in_all(const std::function<void(Answer&)>& damage) {
    return [damage](Answers& answers) {
      for (Answer* one : {&answers.grid, &answers.passes, &answers.embree, &answers.over_triangles}) damage(*one);
    };
  }
};

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST_F(PropertyCheck, NoticesWrongValuesOnWhichAllAgree) {
  // Ten times the largest bound that passes; and, on closed meshes, a whole turn.
  EXPECT_EQ(unnoticed(in_all([](Answer& a) { a.value += 1e-11; })), 0U);
  EXPECT_EQ(unnoticed(in_all([](Answer& a) { a.value += 1; })), 0U);
  EXPECT_EQ(unnoticed(in_all([](Answer& a) { a.value = kNan; })), 0U);
  const auto on_surface = [](const Answers& a) { return a.grid.on_surface; };
  EXPECT_EQ(unnoticed(in_all([](Answer& a) { a.value -= 1; }), on_surface), 0U);
}

TEST_F(PropertyCheck, NoticesOneWayThatDiffersFromTheOthers) {
  EXPECT_EQ(unnoticed([](Answers& a) { a.embree.value = std::nextafter(a.embree.value, 9.0); }), 0U);
  EXPECT_EQ(unnoticed([](Answers& a) { a.passes.degenerate++; }), 0U);
  EXPECT_EQ(unnoticed([](Answers& a) { a.embree.on_surface = !a.embree.on_surface; }), 0U);
  EXPECT_EQ(unnoticed([](Answers& a) { a.over_triangles.value += 1e-11; }), 0U);
  EXPECT_EQ(unnoticed([](Answers& a) { a.over_triangles.value = kNan; }), 0U);
  EXPECT_EQ(unnoticed([](Answers& a) { a.over_triangles.error_bound = 1e-9; }), 0U);
}

TEST_F(PropertyCheck, NoticesWrongFlagsCountsAndBounds) {
  EXPECT_EQ(unnoticed(in_all([](Answer& a) { a.on_surface = !a.on_surface; })), 0U);
  EXPECT_EQ(unnoticed(in_all([](Answer& a) { a.degenerate += 1; })), 0U);
  EXPECT_EQ(unnoticed(in_all([](Answer& a) { a.error_bound = 1e-9; })), 0U);
  EXPECT_EQ(unnoticed(in_all([](Answer& a) { a.error_bound = kNan; })), 0U);
  EXPECT_EQ(unnoticed(in_all([](Answer& a) { a.error_bound = 1e-300; }), [](const Answers& a) { return a.closed; }),
            0U);
}

TEST_F(PropertyCheck, NoticesAMeshThatIsNotTheOneEvaluated) {
  std::size_t noticed = 0, all = 0;
  for (const auto& [mesh, answers] : evaluated()) {
    TriangleMesh other = mesh;
    other.triangles.push_back({0, 1, 2});
    for (const Answers& one : answers) {
      CheckCounts counts;
      noticed += wrong(other, one, counts).has_value();
      ++all;
    }
  }
  EXPECT_GT(noticed, all / 4);  // a triangle without area, or far from the query, changes nothing
}

TEST(PropertyCheckText, DescribesTheFailure) {
  const Case c = make_case(0, 1);
  EXPECT_NE(describe(c.mesh, {{1, 2, 3}, "what"}).find("# query 1 2 3"), std::string::npos);
}

}  // namespace
}  // namespace raycone::test
