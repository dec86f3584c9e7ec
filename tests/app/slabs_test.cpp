// How lattices are cut for evaluation.
#include "app/samples/slabs.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "tests/support/output_checks.h"

namespace raycone::test {
namespace {

constexpr SlabKind kClosed{};
constexpr SlabKind kOpen{.open = true};

// Slabs of `lattice` along `axis`: each where its predecessor ended, each ending at a multiple of `alignment` but for
// the last, none empty or above `most` samples; together all samples.
void expect_partition(const Lattice& lattice, int axis, std::int64_t alignment, std::int64_t most) {
  const auto a = static_cast<std::size_t>(axis);
  std::int64_t next = lattice.index_min[a];
  while (next <= lattice.index_max(axis)) {
    const LatticeBlock slab = slab_from(lattice, axis, alignment, next);
    ASSERT_EQ(slab.first[a], next);
    ASSERT_GT(slab.counts[a], 0);
    EXPECT_LE(slab.size(), most);
    next += slab.counts[a];
    EXPECT_TRUE(next % alignment == 0 || next == lattice.index_max(axis) + 1) << next;
    for (std::size_t other = 0; other < 3; ++other) {
      const bool across = other != a;
      EXPECT_TRUE(!across || slab.counts[other] == lattice.counts[other]);
    }
  }
  EXPECT_EQ(next, lattice.index_max(axis) + 1);
  EXPECT_EQ(slab_from(lattice, axis, alignment, next).size(), 0) << "behind the end there is nothing";
}

TEST(SlabFrom, PartitionsTheLatticeAtAlignedIndices) {
  Lattice lattice;
  lattice.index_min = {0, 0, -13};
  lattice.counts = {300, 300, 200};
  expect_partition(lattice, 2, 8, std::int64_t{1} << 22);
  expect_partition(lattice, 0, 1, std::int64_t{1} << 22);
}

TEST(SlabFrom, HoldsOneAlignedGroupWhereLayersAreLarge) {
  Lattice lattice;
  lattice.index_min = {0, 0, 3};
  lattice.counts = {4000, 4000, 40};
  expect_partition(lattice, 2, 8, 8 * 16'000'000);
  expect_partition(lattice, 2, 1, 16'000'000);
}

TEST(SlabFrom, HoldsSmallLatticesWhole) {
  Lattice lattice;
  lattice.index_min = {-5, -5, -5};
  lattice.counts = {50, 50, 50};
  EXPECT_EQ(slab_from(lattice, 2, 8, -5).size(), 125'000);
}

TEST(SlabMemory, IsThatOfItsNumbers) {
  const LatticeBlock slab{{0, 0, 0}, {1000, 1000, 8}};
  FieldOptions options;
  EXPECT_EQ(slab_memory(slab, options, {false}), 64e6 + 24e6);        // and what the scan takes for each
  EXPECT_EQ(slab_memory(slab, options, {true}), 64e6 + 24e6 + 64e6);  // and crossings of caps
  options.tolerance = 0.0;                                            // which the direct sum does without
  EXPECT_EQ(slab_memory(slab, options, {true}), 64e6 + 24e6);
  options.fields = {Field::kInside};  // comes from the winding number
  EXPECT_EQ(slab_memory(slab, options, {false}), 64e6 + 24e6 + 8e6);
  EXPECT_EQ(slab_memory(slab, options, {true}), 64e6 + 24e6 + 8e6 + 64e6);  // a rule has caps, always
  options.diagnostics = true;                                               // two 64-bit counts, a flag, a double
  EXPECT_EQ(slab_memory(slab, options, {false, false, true}), 8e6 + 24e6) << "sides alone";
  EXPECT_EQ(slab_memory(slab, options, {true}), 64e6 + 24e6 + 8e6 + 8e6 * (8 + 8 + 1 + 8));
}

TEST(WriterMemory, CountsTheGridOfAnOpenMeshInFull) {
  Lattice lattice;
  lattice.counts = {1000, 1000, 1000};
  OutputDescription description;
  EXPECT_EQ(writer_memory(lattice, FieldFormat::kNpy, description, kOpen), 0.0);
  EXPECT_EQ(writer_memory(lattice, FieldFormat::kVdb, description, kOpen), 4e9 + 4 * 8e6);
  description.precision = Precision::kDouble;
  EXPECT_EQ(writer_memory(lattice, FieldFormat::kVdb, description, kOpen), 8e9 + 8 * 8e6);
  EXPECT_LT(writer_memory(lattice, FieldFormat::kVdb, {}, kClosed), 1e8);
}

// --band all asks for a band as wide as the lattice is long from corner to corner.
TEST(WriterMemory, CountsDistancesInFullWhereTheBandIsEverywhere) {
  const auto of_band = [](const std::array<std::int64_t, 3>& counts, double band) {
    Lattice lattice;
    lattice.spacing = {1, 1, 1};
    lattice.counts = counts;
    OutputDescription description;
    description.fields = {{"sdf", "sdf", "surface", FieldKind::kDistance, band, ""}};
    return writer_memory(lattice, FieldFormat::kVdb, description, kClosed);
  };
  EXPECT_EQ(of_band({400, 400, 400}, std::hypot(399, 399, 399)), 4 * 64e6 + 4 * 8 * 160e3);
  EXPECT_EQ(of_band({10, 10, 4000}, std::hypot(9, 9, 3999)), 4 * 400e3 + 4 * 8 * 100) << "less than the longest side";
  EXPECT_LT(of_band({400, 400, 400}, 3), 2e7);
}

TEST(WriterMemory, CountsFlagsAtTheSurfaceOnly) {
  Lattice lattice;
  lattice.counts = {2048, 2048, 2048};
  OutputDescription description;
  description.fields = {{"inside", "inside", "inside", FieldKind::kFlag, 0.0, ""}};
  EXPECT_LT(writer_memory(lattice, FieldFormat::kVdb, description, kOpen), 1e8);
}

// Which its writer keeps.
TEST(WriterMemory, CountsTheTextsOfARowOfCsv) {
  Lattice lattice;
  lattice.counts = {2'000'000'000, 1, 1};
  EXPECT_EQ(writer_memory(lattice, FieldFormat::kCsv, {}, kClosed), 2 * sizeof(std::string) * 2e9);
  EXPECT_EQ(writer_memory(lattice, FieldFormat::kCsv, {}, {.turned = true}), sizeof(std::string) * 2e9);
}

TEST(WriterMemory, CountsTheErrorBoundsOfAnOpenMeshInFull) {
  Lattice lattice;
  lattice.counts = {1000, 1000, 1000};
  OutputDescription description = described_with_diagnostics();
  EXPECT_LT(writer_memory(lattice, FieldFormat::kVdb, description, kClosed), 3e8) << "closed: no bound differs from 0";
  EXPECT_EQ(writer_memory(lattice, FieldFormat::kVdb, description, kOpen), 2 * 4e9 + (4 + 3 * 4 + 1) * 8e6);
}

}  // namespace
}  // namespace raycone::test
