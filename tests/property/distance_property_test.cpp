// A short, seeded run of generated distances; raycone_distances runs them for hours.
#include <gtest/gtest.h>

#include "tests/property/cases.h"
#include "tests/property/distance_check.h"

namespace raycone::test {
namespace {

TEST(DistanceProperty, HoldsForGeneratedMeshes) {
  DistanceCounts counts;
  for (std::size_t family = 0; family < family_count(); ++family) {
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      const Case c = make_case(family, seed);
      const auto failure = check_distances(c.mesh, c.queries, counts);
      ASSERT_FALSE(failure) << c.family << ", seed " << seed << "\n" << describe(c.mesh, *failure);
    }
  }
  EXPECT_GT(counts.on_surface, 100U);  // else the generator has lost its point
}

TEST(DistanceProperty, LatticesOfGeneratedMeshesArePoints) {
  DistanceCounts counts;
  for (std::size_t family = 0; family < family_count(); ++family) {
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      const Case c = make_case(family, seed);
      Random random(seed);
      const auto failure = check_lattice_distances(c.mesh, any_lattice(c.mesh, random), counts);
      ASSERT_FALSE(failure) << c.family << ", seed " << seed << "\n" << describe(c.mesh, *failure);
    }
  }
  EXPECT_GT(counts.in_band, counts.samples / 20);
  EXPECT_LT(counts.in_band, counts.samples);
}

}  // namespace
}  // namespace raycone::test
