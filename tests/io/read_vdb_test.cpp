#include "io/vdb/read_vdb.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <string>
#include <vector>

#include "core/data/placed_lattice.h"
#include "io/files/file_error.h"
#include "tests/io/vdb_field.h"
#include "tests/support/error_text.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/text_files.h"
#include "tests/support/vdb_files.h"

namespace raycone {
namespace {

using test::ball_field;
using test::field_of;
using test::read_text;
using test::TemporaryDirectory;
using test::VdbField, test::VdbGridToWrite, test::VdbTransform;
using test::write_vdb, test::write_vdb_grids;

// As another program would write it.
VdbGridToWrite named_grid(const std::string& name, const VdbTransform& transform) {
  return {name, transform, {{-5, 2, 30}, {4, 2, 100}}};
}

std::string input_error_of(const std::string& path, const std::string& name) {
  return test::error_text<InputError>([&] { return read_vdb_lattice(path, name); });
}

void expect_same(const PlacedLattice& actual, const PlacedLattice& expected) {
  EXPECT_EQ(actual.origin, expected.origin);
  EXPECT_EQ(actual.steps, expected.steps);
  EXPECT_EQ(actual.grid.origin, expected.grid.origin);
  EXPECT_EQ(actual.grid.spacing, expected.grid.spacing);
  EXPECT_EQ(actual.grid.index_min, expected.grid.index_min);
  EXPECT_EQ(actual.grid.counts, expected.grid.counts);
}

TEST(ReadVdbLattice, ReturnsTheLatticeThatRayconeRecorded) {
  const TemporaryDirectory directory;
  const VdbField field = ball_field();  // zero at its borders
  write_vdb(directory / "out.vdb", field);
  expect_same(read_vdb_lattice(directory / "out.vdb", ""), field.lattice);
  expect_same(read_vdb_lattice(directory / "out.vdb", "winding"), field.lattice);
}

TEST(ReadVdbLattice, ReturnsTheRecordedLatticeOfAnEmptyGrid) {
  const TemporaryDirectory directory;
  const VdbField field = field_of({4, 5, 6}, [](auto, auto, auto) { return 0.0; });
  write_vdb(directory / "out.vdb", field);
  expect_same(read_vdb_lattice(directory / "out.vdb", ""), field.lattice);
}

TEST(ReadVdbLattice, ReturnsTheBoxOfActiveVoxelsOfOtherPrograms) {
  const TemporaryDirectory directory;
  write_vdb_grids(directory / "in.vdb", {named_grid("density", VdbTransform(0.5).translate({1, 2, 3}))});
  expect_same(read_vdb_lattice(directory / "in.vdb", ""),
              Lattice{{1, 2, 3}, {0.5, 0.5, 0.5}, {-5, 2, 30}, {10, 1, 71}});
}

TEST(ReadVdbLattice, ReadsTheTreeWhereTheFileHasNoStatistics) {
  const TemporaryDirectory directory;
  write_vdb_grids(directory / "in.vdb", {named_grid("density", VdbTransform(2))}, test::VdbStatistics::kWithout);
  expect_same(read_vdb_lattice(directory / "in.vdb", ""), Lattice{{0, 0, 0}, {2, 2, 2}, {-5, 2, 30}, {10, 1, 71}});
}

TEST(ReadVdbLattice, ReadsStreamsWithoutTableOfContents) {
  const TemporaryDirectory directory;
  test::write_vdb_stream(directory / "in.vdb", {named_grid("a", VdbTransform(1)), named_grid("b", VdbTransform(2))});
  expect_same(read_vdb_lattice(directory / "in.vdb", "b"), Lattice{{0, 0, 0}, {2, 2, 2}, {-5, 2, 30}, {10, 1, 71}});
}

TEST(ReadVdbLattice, TakesTheFirstGridOfTheFileWhateverItsName) {
  const TemporaryDirectory directory;
  const std::vector<test::VdbGridToWrite> grids{named_grid("c", VdbTransform(1)), named_grid("a", VdbTransform(2)),
                                                named_grid("b", VdbTransform(3))};
  const std::string path = directory / "in.vdb";
  for (int how = 0; how < 3; ++how) {
    if (how == 0) {
      write_vdb_grids(path, grids);
    } else if (how == 1) {
      write_vdb_grids(path, grids, test::VdbStatistics::kWithout);
    } else {
      test::write_vdb_stream(path, grids);
    }
    EXPECT_EQ(read_vdb_lattice(path, "").grid.spacing.x, 1.0) << how;
    EXPECT_EQ(read_vdb_lattice(path, "b").grid.spacing.x, 3.0) << how;
    const VolumeFacts facts = read_vdb_facts(path);
    ASSERT_EQ(facts.arrays.size(), 3U) << how;
    EXPECT_EQ(facts.arrays[0].name + facts.arrays[1].name + facts.arrays[2].name, "cab") << how;
    ASSERT_TRUE(facts.lattice) << how << facts.no_lattice;
    EXPECT_EQ(facts.lattice->grid.spacing.x, 1.0) << how;
  }
}

TEST(ReadVdbLattice, AcceptsAnAffineMapThatScalesOnly) {
  const TemporaryDirectory directory;
  const std::array<double, 16> matrix{0.1, 0.0, 0.0, 0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 0.0, 0.3, 0.0, 7.0, 8.0, 9.0, 1.0};
  write_vdb_grids(directory / "in.vdb", {named_grid("density", VdbTransform::affine(matrix))});
  expect_same(read_vdb_lattice(directory / "in.vdb", ""),
              Lattice{{7, 8, 9}, {0.1, 0.2, 0.3}, {-5, 2, 30}, {10, 1, 71}});
}

TEST(ReadVdbLattice, FindsGridsByName) {
  const TemporaryDirectory directory;
  write_vdb_grids(directory / "in.vdb", {named_grid("b", VdbTransform(2)), named_grid("a", VdbTransform(1))});
  EXPECT_EQ(read_vdb_lattice(directory / "in.vdb", "a").grid.spacing.x, 1.0);
  EXPECT_EQ(read_vdb_lattice(directory / "in.vdb", "").grid.spacing.x, 2.0);
  EXPECT_EQ(input_error_of(directory / "in.vdb", "c"),
            directory / "in.vdb" + ": has no grid 'c', expected one of: b, a");
}

TEST(ReadVdbLattice, ReturnsTransformsOfAnyDirection) {
  const TemporaryDirectory directory;
  const auto lattice_of = [&](const VdbTransform& transform) {
    write_vdb_grids(directory / "in.vdb", {named_grid("g", transform)});
    return read_vdb_lattice(directory / "in.vdb", "");
  };
  const auto steps_of = [&](const std::array<Vec3, 3>& steps) {
    return PlacedLattice({0, 0, 0}, steps, {-5, 2, 30}, {10, 1, 71});
  };
  expect_same(lattice_of(VdbTransform(1).scale({1, -1, 1})), steps_of({{{1, 0, 0}, {0, -1, 0}, {0, 0, 1}}}));
  const PlacedLattice turned = lattice_of(VdbTransform(2).rotate_about_x(0.5));
  EXPECT_NEAR(turned.steps[1].y, 2 * std::cos(0.5), 1e-15);
  EXPECT_NEAR(std::abs(turned.steps[1].z), 2 * std::sin(0.5), 1e-15);
  EXPECT_NEAR(turned.signed_volume(), 8, 1e-14);
  const std::array<double, 16> matrix{0.1, 0.5, 0.0, 0.0, 0.0, 0.2, 0.7, 0.0, 0.0, 0.0, 0.3, 0.0, 7.0, 8.0, 9.0, 1.0};
  expect_same(lattice_of(VdbTransform::affine(matrix)),
              {{7, 8, 9}, {{{0.1, 0.5, 0}, {0, 0.2, 0.7}, {0, 0, 0.3}}}, {-5, 2, 30}, {10, 1, 71}});
}

TEST(ReadVdbLattice, RefusesTransformsThatAreNotLinear) {
  const TemporaryDirectory directory;
  write_vdb_grids(directory / "in.vdb", {named_grid("g", VdbTransform::frustum())});
  EXPECT_EQ(input_error_of(directory / "in.vdb", ""),
            directory / "in.vdb" + ": grid 'g' has a frustum transform, expected a linear one");
}

TEST(ReadVdbLattice, RefusesAnEmptyGridWithoutRecordedLattice) {
  const TemporaryDirectory directory;
  write_vdb_grids(directory / "in.vdb", {{"g", VdbTransform(), {}}});
  EXPECT_EQ(input_error_of(directory / "in.vdb", ""),
            directory / "in.vdb" + ": grid 'g' has no active voxels, expected some, or a lattice recorded by raycone");
}

TEST(ReadVdbLattice, RefusesWhatIsNotAnOpenVdbFile) {
  const TemporaryDirectory directory;
  EXPECT_EQ(input_error_of(directory / "missing", ""),
            directory / "missing" + ": cannot read: No such file or directory");
  EXPECT_EQ(input_error_of(directory.path().string(), ""),
            directory.path().string() + ": cannot read: not a regular file");
  std::ofstream(directory / "empty").flush();
  EXPECT_TRUE(
      input_error_of(directory / "empty", "").starts_with(directory / "empty" + ": not a readable OpenVDB file"));
  std::ofstream(directory / "text") << "solid cube";
  EXPECT_TRUE(input_error_of(directory / "text", "").starts_with(directory / "text" + ": not a readable OpenVDB file"));
}

// Cut anywhere, a file is refused or, from where its head is complete, read as before.
TEST(ReadVdbLattice, SurvivesTruncatedFiles) {
  const TemporaryDirectory directory;
  const VdbField field = field_of({9, 9, 9}, [](auto x, auto y, auto z) { return static_cast<double>(x + y + z); });
  write_vdb(directory / "whole", field);
  const std::string whole = read_text(directory / "whole");
  for (std::size_t size = 0; size < whole.size(); size += 61) {
    const std::string cut = directory / std::to_string(size);
    std::ofstream(cut, std::ios::binary) << whole.substr(0, size);
    try {
      expect_same(read_vdb_lattice(cut, ""), field.lattice);
    } catch (const InputError&) {
    }
  }
}

}  // namespace
}  // namespace raycone
