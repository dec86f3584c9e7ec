// A short, seeded run of the generated cases; raycone_stress runs them for hours.
#include <gtest/gtest.h>

#include "tests/property/cases.h"
#include "tests/property/check.h"

namespace raycone::test {
namespace {

class Property : public testing::TestWithParam<std::size_t> {};

TEST_P(Property, HoldsForGeneratedMeshes) {
  CheckCounts counts;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const Case c = make_case(GetParam(), seed);
    const auto failure = check(c.mesh, c.queries, &counts);
    ASSERT_FALSE(failure) << "seed " << seed << "\n" << describe(shrink(c.mesh, failure->query), *failure);
  }
  EXPECT_GT(counts.degenerate, 100U);  // else the generator has lost its point
}

INSTANTIATE_TEST_SUITE_P(Families, Property, testing::Range(std::size_t{0}, family_count()),
                         [](const auto& family) { return std::to_string(family.param); });

TEST(PropertyCheck, NoticesAWrongValue) {  // negative control: a mesh that is not the one evaluated
  const Case c = make_case(0, 1);
  TriangleMesh other = c.mesh;
  other.triangles.push_back({0, 1, 2});
  EXPECT_FALSE(check(c.mesh, c.queries));
  EXPECT_NE(describe(other, {{1, 2, 3}, "what"}).find("# query 1 2 3"), std::string::npos);
}

}  // namespace
}  // namespace raycone::test
