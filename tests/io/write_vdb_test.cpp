#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "core/machine/threads.h"
#include "io/fields/field_writer.h"
#include "io/files/file_error.h"
#include "io/vdb/read_vdb.h"
#include "tests/io/vdb_field.h"
#include "tests/support/output_checks.h"
#include "tests/support/pipe.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/text_files.h"
#include "tests/support/vdb_files.h"

namespace raycone {
namespace {

using test::ball_field;
using test::described_mesh;
using test::field_of;
using test::output_error_of;
using test::read_text;
using test::TemporaryDirectory;
using test::VdbClass, test::VdbField, test::VdbGrid, test::VdbGridPtr, test::VdbType;
using test::VoxelIndex, test::read_vdb_grid, test::write_vdb;

VdbField random_field() {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  return field_of({29, 18, 37}, [&](auto, auto, auto) { return random() % 4 == 0 ? 0.0 : normal(random); });
}

VdbGridPtr written_grid(const VdbField& field, const OutputDescription& description = described_mesh(),
                        VdbType type = VdbType::kFloat) {
  const TemporaryDirectory directory;
  write_vdb(directory / "out.vdb", field, description);
  return read_vdb_grid(directory / "out.vdb", "winding", type);
}

// Every voxel of the lattice, and one layer around it, has the value and activity that the field asks for.
void expect_holds(const VdbGrid& grid, const VdbField& field) {
  const Lattice& lattice = field.lattice;
  const bool wide = grid.type() == VdbType::kDouble;
  const auto inside = [&](std::int64_t n, std::size_t axis) { return 0 <= n && n < lattice.counts[axis]; };
  std::size_t active = 0;
  for (std::int64_t z = -1; z <= lattice.counts[2]; ++z) {
    for (std::int64_t y = -1; y <= lattice.counts[1]; ++y) {
      for (std::int64_t x = -1; x <= lattice.counts[0]; ++x) {
        double expected = 0;
        if (inside(x, 0) && inside(y, 1) && inside(z, 2)) {
          const double value = field.values[LatticeBlock{{}, lattice.counts}.number_of({x, y, z})];
          expected = wide ? value : static_cast<float>(value);
        }
        const VoxelIndex at{static_cast<int>(lattice.index_min[0] + x), static_cast<int>(lattice.index_min[1] + y),
                            static_cast<int>(lattice.index_min[2] + z)};
        ASSERT_EQ(grid.value(at), expected) << at;
        ASSERT_EQ(grid.is_active(at), expected != 0) << at;
        active += expected != 0 ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(grid.active_voxel_count(), active);
}

TEST(WriteVdb, HoldsEveryVoxel) { expect_holds(*written_grid(random_field()), random_field()); }

TEST(WriteVdb, HoldsEveryVoxelBesideTiles) { expect_holds(*written_grid(ball_field()), ball_field()); }

TEST(WriteVdb, HoldsDoublesOnRequest) {
  OutputDescription description = described_mesh();
  description.precision = Precision::kDouble;
  expect_holds(*written_grid(random_field(), description, VdbType::kDouble), random_field());
}

TEST(WriteVdb, HoldsASingleSample) {
  const VdbField field = field_of({1, 1, 1}, [](auto, auto, auto) { return 0.25; });
  expect_holds(*written_grid(field), field);
}

TEST(WriteVdb, DoesNotDependOnTheSlabs) {
  const TemporaryDirectory directory;
  write_vdb(directory / "aligned", ball_field(), described_mesh(), 66);
  for (const std::int64_t thickness : {1, 3, 8, 13}) {
    write_vdb(directory / "other", ball_field(), described_mesh(), thickness);
    EXPECT_EQ(read_text(directory / "other"), read_text(directory / "aligned")) << thickness;
  }
}

TEST(WriteVdb, StoresNothingForZeros) {
  const auto grid = written_grid(field_of({40, 40, 40}, [](auto, auto, auto) { return -0.0; }));
  EXPECT_TRUE(grid->is_empty());
}

// What is 0 in single precision is background, however it was computed.
TEST(WriteVdb, StoredValuesDecideActivity) {
  const auto grid = written_grid(field_of({9, 9, 9}, [](auto x, auto, auto) { return x == 4 ? 1e-300 : -0.0; }));
  EXPECT_TRUE(grid->is_empty());
}

TEST(WriteVdb, NegativeZeroIsStoredAsZero) {
  const auto grid = written_grid(field_of({9, 9, 9}, [](auto x, auto, auto) { return x == 4 ? 1.0 : -0.0; }));
  EXPECT_EQ(grid->value({-9, 0, -20}), 1.0);
  EXPECT_FALSE(std::signbit(grid->value({-8, 0, -20})));
}

TEST(WriteVdb, ConstantBlocksAreTiles) {
  VdbField field = field_of({64, 64, 64}, [](auto, auto, auto) { return 1.0; });
  field.lattice.index_min = {-32, 0, 64};
  const auto grid = written_grid(field);
  EXPECT_EQ(grid->leaf_count(), 0U);
  EXPECT_EQ(grid->active_tile_count(), 512U);
  expect_holds(*grid, field);
}

TEST(WriteVdb, LargeConstantBlocksAreLargeTiles) {
  VdbField field = field_of({128, 128, 128}, [](auto, auto, auto) { return 1.0; });
  field.lattice.index_min = {-128, 0, 128};
  EXPECT_EQ(written_grid(field)->active_tile_count(), 1U);
}

TEST(WriteVdb, TransformPlacesSamplesWhereTheyWereTaken) {
  const VdbField field = random_field();
  const auto grid = written_grid(field);
  const Vec3 world = grid->position({-13, 5, 2});
  EXPECT_EQ(world.x, field.lattice.coordinate(0, -13));
  EXPECT_EQ(world.y, field.lattice.coordinate(1, 5));
  EXPECT_EQ(world.z, field.lattice.coordinate(2, 2));
  EXPECT_FALSE(grid->has_uniform_scale());
}

// OpenVDB's constructors of transforms would round these spacings to one.
TEST(WriteVdb, TransformIsExact) {
  VdbField field = field_of({2, 2, 2}, [](auto, auto, auto) { return 1.0; });
  field.lattice.spacing = {0.1, std::nextafter(0.1, 1.0), std::nextafter(0.1, 0.0)};
  field.lattice.origin = {1e6, -1e-6, 0.3};
  const TemporaryDirectory directory;
  write_vdb(directory / "out.vdb", field);
  const Lattice actual = read_vdb_lattice(directory / "out.vdb", "").grid;
  EXPECT_EQ(actual.spacing, field.lattice.spacing);
  EXPECT_EQ(actual.origin, field.lattice.origin);
}

TEST(WriteVdb, CubicVoxelsHaveUniformScale) {
  VdbField field = random_field();
  field.lattice.spacing = {0.1, 0.1, 0.1};
  const auto grid = written_grid(field);
  EXPECT_TRUE(grid->has_uniform_scale());
  EXPECT_EQ(grid->position({-13, 5, 2}).x, field.lattice.coordinate(0, -13));
}

TEST(WriteVdb, DescribesItself) {
  OutputDescription description = described_mesh();
  description.fields.front().rule = "threshold=0.5";
  const auto grid = written_grid(random_field(), description);
  EXPECT_EQ(grid->name(), "winding");
  EXPECT_EQ(grid->grid_class(), VdbClass::kUnknown);
  EXPECT_EQ(grid->background(), 0.0);
  EXPECT_FALSE(grid->text("raycone_version").empty());
  EXPECT_EQ(grid->text("raycone_field"), "winding");
  EXPECT_EQ(grid->text("raycone_rule"), "threshold=0.5");
  EXPECT_EQ(grid->text("raycone_mesh"), "bunny.obj");
  EXPECT_EQ(grid->text("raycone_sha256"), "0123456789abcdef");
  EXPECT_EQ(grid->index("raycone_index_min"), (std::array<int, 3>{-13, -3, -21}));
  EXPECT_EQ(grid->index("raycone_index_max"), (std::array<int, 3>{15, 14, 15}));
  EXPECT_EQ(grid->integer("raycone_faces"), 5'000'000'000);
  EXPECT_EQ(grid->integer("raycone_exterior_edges"), 42);
  EXPECT_EQ(grid->integer("raycone_degenerate"), 7);
  EXPECT_EQ(grid->integer("raycone_on_surface"), 9);
}

TEST(WriteVdb, HasNoRuleWhereTheFieldHasNone) {
  const auto grid = written_grid(random_field());
  EXPECT_FALSE(grid->has_metadata("raycone_rule"));
}

// Neither the clock, nor the directory, nor OpenVDB's random identifier show.
TEST(WriteVdb, IsByteIdenticalOnEveryRun) {
  const TemporaryDirectory first;
  const TemporaryDirectory second;
  write_vdb(first / "out.vdb", ball_field());
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  write_vdb(second / "out.vdb", ball_field());
  EXPECT_EQ(read_text(first / "out.vdb"), read_text(second / "out.vdb"));
}

TEST(WriteVdb, IsByteIdenticalForAnyNumberOfThreads) {
  const TemporaryDirectory directory;
  for (const int threads : {1, 2, 7}) {
    const ThreadLimit limit(threads);
    write_vdb(directory / std::to_string(threads), ball_field());
  }
  EXPECT_EQ(read_text(directory / "1"), read_text(directory / "2"));
  EXPECT_EQ(read_text(directory / "1"), read_text(directory / "7"));
}

std::string identifier_in(const std::string& vdb) { return vdb.substr(21, 36); }

TEST(WriteVdb, IdentifierFollowsTheContent) {
  const TemporaryDirectory directory;
  VdbField field = ball_field();
  write_vdb(directory / "one", field);
  field.values[field.values.size() / 2] += 0.5;
  write_vdb(directory / "other", field);
  const std::string identifier = identifier_in(read_text(directory / "one"));
  EXPECT_NE(identifier, identifier_in(read_text(directory / "other")));
  for (std::size_t n = 0; n < identifier.size(); ++n) {
    const bool hyphen = n == 8 || n == 13 || n == 18 || n == 23;
    EXPECT_TRUE(hyphen ? identifier[n] == '-' : std::isxdigit(identifier[n]) != 0) << identifier;
  }
}

TEST(WriteVdb, IsTheSameThroughAPipe) {
  const TemporaryDirectory directory;
  write_vdb(directory / "file", ball_field());
  const auto write = [](const std::string& path) { write_vdb(path, ball_field()); };
  EXPECT_EQ(test::received_through_pipe(write), read_text(directory / "file"));
}

TEST(WriteVdb, ReportsAFullDisk) {
  EXPECT_EQ(output_error_of([] { write_vdb("/dev/full", ball_field()); }),
            "/dev/full: cannot write: No space left on device");
}

// The failure happens inside OpenVDB, which does not look at its stream.
TEST(WriteVdb, ReportsTheFileSizeLimit) {
  const TemporaryDirectory directory;
  rlimit saved{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &saved), 0);
  const auto saved_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{4096, saved.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string message = output_error_of([&] { write_vdb(directory / "out.vdb", random_field()); });
  setrlimit(RLIMIT_FSIZE, &saved);
  std::signal(SIGXFSZ, saved_handler);
  EXPECT_EQ(message, directory / "out.vdb" + ": cannot write: File too large");
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

TEST(WriteVdb, RefusesVoxelsThatOpenVdbTakesForSingular) {
  const TemporaryDirectory directory;
  VdbField field = field_of({1, 1, 1}, [](auto, auto, auto) { return 1.0; });
  const auto write = [&] { write_vdb(directory / "out.vdb", field); };
  field.lattice.spacing = {1.2e-9, 1e-9, 1e-9};
  EXPECT_EQ(output_error_of(write), directory / "out.vdb" +
                                        ": voxel volume 1.2e-27 is below 3e-15, which OpenVDB cannot represent; "
                                        "scale the mesh (--scale 1e9)");
  field.lattice.spacing = {1e-200, 1e-200, 1e-200};
  EXPECT_TRUE(output_error_of(write).ends_with("(--scale 1e200)"));
  field.lattice.spacing = {1e-5, 1e-5, 2.9e-5};
  EXPECT_TRUE(output_error_of(write).ends_with("(--scale 1e5)"));
  field.lattice.spacing = {1e-5, 1e-5, 3.1e-5};
  write();
  EXPECT_EQ(read_vdb_lattice(directory / "out.vdb", "").grid.spacing, field.lattice.spacing);
}

// OpenVDB copies a grid while it writes it, and the copy's voxels would have no size.
TEST(WriteVdb, RefusesVoxelsBelowTheSpacingOfTheirCoordinates) {
  const TemporaryDirectory directory;
  VdbField field = field_of({1, 1, 1}, [](auto, auto, auto) { return 1.0; });
  const auto write = [&] { write_vdb(directory / "out.vdb", field); };
  field.lattice.spacing = {1, 1, 1};
  field.lattice.origin = {0, 0x1p53, 0};  // the nearest double to 2^53 + 1 is 2^53
  EXPECT_EQ(output_error_of(write),
            directory / "out.vdb" +
                ": voxels of 1 x 1 x 1 at (0, 9e+15, 0) are too small beside their coordinates, which OpenVDB cannot "
                "represent; expected larger ones, or bounds nearer to 0");
  field.lattice.spacing = {1e200, 1e200, 1};
  field.lattice.origin = {0, 0, 0x1p53};
  EXPECT_TRUE(output_error_of(write).ends_with("nearer to 0"));
  field.lattice.spacing = {1, 1, 1};
  field.lattice.origin = {0, 0x1p52, -0x1p53};  // the doubles below 2^53 are 1 apart
  write();
  const Lattice read = read_vdb_lattice(directory / "out.vdb", "").grid;
  EXPECT_EQ(read.origin, field.lattice.origin);
  EXPECT_EQ(read.spacing, field.lattice.spacing);
}

TEST(WriteVdb, RefusesIndicesBeyond32Bits) {
  const TemporaryDirectory directory;
  VdbField field = field_of({2, 1, 1}, [](auto, auto, auto) { return 1.0; });
  field.lattice.index_min[0] = 2147483646;
  write_vdb(directory / "out.vdb", field);
  EXPECT_EQ(read_vdb_grid(directory / "out.vdb", "winding")->value({2147483647, -3, -21}), 1.0);
  field.lattice.index_min[0] = 2147483647;
  EXPECT_EQ(output_error_of([&] { write_vdb(directory / "out.vdb", field); }),
            directory / "out.vdb" + ": lattice indices 2147483647 to 2147483648 do not fit in the 32 bits of OpenVDB");
}

TEST(WriteVdb, PyopenvdbReadsIt) {
  if (!test::python_has("pyopenvdb, numpy")) GTEST_SKIP() << "no pyopenvdb and numpy in /usr/bin/python3";
  const TemporaryDirectory directory;
  const VdbField field = ball_field();
  write_vdb(directory / "out.vdb", field);
  OutputFile npy(directory / "out.npy");
  test::write_in_slabs(FieldFormat::kNpy, npy, field.lattice, {}, field.values, 8);
  EXPECT_EQ(test::run_python("import numpy, pyopenvdb, sys\n"
                             "path = sys.argv[1] + '/out.vdb'\n"
                             "grid = pyopenvdb.read(path, 'winding')\n"
                             "expected = numpy.load(sys.argv[1] + '/out.npy')\n"
                             "actual = numpy.empty(expected.shape, numpy.float32)\n"
                             "grid.copyToArray(actual, ijk=grid.metadata['raycone_index_min'])\n"
                             "assert (actual == expected).all()\n"
                             "assert grid.activeVoxelCount() == numpy.count_nonzero(expected)\n"
                             "assert grid.transform.indexToWorld((1, 1, 0)) == (0.1 + 0.1, -20.7 + 0.3, 1e-3)\n"
                             "assert grid.metadata['raycone_faces'] == 5000000000\n"
                             "head, = pyopenvdb.readAllGridMetadata(path)\n"
                             "assert head.name == 'winding' and head.metadata['raycone_mesh'] == 'bunny.obj'\n",
                             {directory.path().string()}),
            "");
}

}  // namespace
}  // namespace raycone
