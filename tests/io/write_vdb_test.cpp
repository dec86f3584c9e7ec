#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "core/machine/threads.h"
#include "io/fields/field_writer.h"
#include "io/files/file_error.h"
#include "io/vdb/read_vdb.h"
#include "tests/support/output_checks.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/text_files.h"
#include "tests/support/vdb_files.h"

namespace raycone {
namespace {

using test::output_error_of;
using test::read_text;
using test::TemporaryDirectory;
using test::VdbClass, test::VdbGrid, test::VdbGridPtr, test::VdbGridToWrite, test::VdbTransform, test::VdbType;
using test::VoxelIndex, test::read_vdb_grid, test::write_vdb_grids;

struct Field {
  Lattice lattice;
  std::vector<double> values;
};

// A field on an anisotropic lattice whose indices start and end inside leaf blocks, on either side of 0.
Field field_of(const std::array<std::int64_t, 3>& counts,
               const std::function<double(std::int64_t, std::int64_t, std::int64_t)>& value) {
  Field field;
  field.lattice = {{0.1, -20.7, 1e-3}, {0.1, 0.3, 1.0 / 3}, {-13, -3, -21}, counts};
  for (std::int64_t z = 0; z < counts[2]; ++z) {
    for (std::int64_t y = 0; y < counts[1]; ++y) {
      for (std::int64_t x = 0; x < counts[0]; ++x) field.values.push_back(value(x, y, z));
    }
  }
  return field;
}

Field random_field() {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  return field_of({29, 18, 37}, [&](auto, auto, auto) { return random() % 4 == 0 ? 0.0 : normal(random); });
}

// 0 outside a ball, 1 inside, random between: leaves, tiles and nothing, all in one grid.
Field ball_field() {
  std::mt19937 random(1);
  return field_of({70, 65, 66}, [&](auto x, auto y, auto z) {
    const double r = std::hypot(static_cast<double>(x) - 35, static_cast<double>(y) - 32, static_cast<double>(z) - 33);
    return r < 20 ? 1.0 : r > 25 ? 0.0 : std::uniform_real_distribution<double>(0, 1)(random);
  });
}

OutputDescription described_mesh() {
  OutputDescription description;
  description.mesh = "bunny.obj";
  description.mesh_sha256 = "0123456789abcdef";
  description.faces = 5'000'000'000;  // beyond 32 bits
  return description;
}

void write_vdb(const std::string& path, const Field& field, const OutputDescription& description = described_mesh(),
               std::int64_t thickness = 8) {
  OutputFile output(path);
  test::write_in_slabs(FieldFormat::kVdb, output, field.lattice, description, field.values, thickness, {7, 9, 42});
}

VdbGridPtr written_grid(const Field& field, const OutputDescription& description = described_mesh(),
                        VdbType type = VdbType::kFloat) {
  const TemporaryDirectory directory;
  write_vdb(directory / "out.vdb", field, description);
  return read_vdb_grid(directory / "out.vdb", "winding", type);
}

// Every voxel of the lattice, and one layer around it, has the value and activity that the field asks for.
void expect_holds(const VdbGrid& grid, const Field& field) {
  const Lattice& lattice = field.lattice;
  const bool wide = grid.type() == VdbType::kDouble;
  const auto inside = [&](std::int64_t n, std::size_t axis) { return 0 <= n && n < lattice.counts[axis]; };
  std::size_t active = 0;
  for (std::int64_t z = -1; z <= lattice.counts[2]; ++z) {
    for (std::int64_t y = -1; y <= lattice.counts[1]; ++y) {
      for (std::int64_t x = -1; x <= lattice.counts[0]; ++x) {
        double expected = 0;
        if (inside(x, 0) && inside(y, 1) && inside(z, 2)) {
          const std::int64_t n = (z * lattice.counts[1] + y) * lattice.counts[0] + x;
          const double value = field.values[static_cast<std::size_t>(n)];
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
  const Field field = field_of({1, 1, 1}, [](auto, auto, auto) { return 0.25; });
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
  Field field = field_of({64, 64, 64}, [](auto, auto, auto) { return 1.0; });
  field.lattice.index_min = {-32, 0, 64};
  const auto grid = written_grid(field);
  EXPECT_EQ(grid->leaf_count(), 0U);
  EXPECT_EQ(grid->active_tile_count(), 512U);
  expect_holds(*grid, field);
}

TEST(WriteVdb, LargeConstantBlocksAreLargeTiles) {
  Field field = field_of({128, 128, 128}, [](auto, auto, auto) { return 1.0; });
  field.lattice.index_min = {-128, 0, 128};
  EXPECT_EQ(written_grid(field)->active_tile_count(), 1U);
}

TEST(WriteVdb, TransformPlacesSamplesWhereTheyWereTaken) {
  const Field field = random_field();
  const auto grid = written_grid(field);
  const Vec3 world = grid->position({-13, 5, 2});
  EXPECT_EQ(world.x, field.lattice.coordinate(0, -13));
  EXPECT_EQ(world.y, field.lattice.coordinate(1, 5));
  EXPECT_EQ(world.z, field.lattice.coordinate(2, 2));
  EXPECT_FALSE(grid->has_uniform_scale());
}

// OpenVDB's constructors of transforms would round these spacings to one.
TEST(WriteVdb, TransformIsExact) {
  Field field = field_of({2, 2, 2}, [](auto, auto, auto) { return 1.0; });
  field.lattice.spacing = {0.1, std::nextafter(0.1, 1.0), std::nextafter(0.1, 0.0)};
  field.lattice.origin = {1e6, -1e-6, 0.3};
  const TemporaryDirectory directory;
  write_vdb(directory / "out.vdb", field);
  const Lattice actual = read_vdb_lattice(directory / "out.vdb", "").grid;
  EXPECT_EQ(actual.spacing, field.lattice.spacing);
  EXPECT_EQ(actual.origin, field.lattice.origin);
}

TEST(WriteVdb, CubicVoxelsHaveUniformScale) {
  Field field = random_field();
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
  Field field = ball_field();
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
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  std::string received;
  std::thread reader([&] {
    std::vector<char> bytes(65536);
    for (ssize_t count; (count = read(ends[0], bytes.data(), bytes.size())) > 0;) {
      received.append(bytes.data(), static_cast<std::size_t>(count));
    }
  });
  write_vdb("/dev/fd/" + std::to_string(ends[1]), ball_field());
  close(ends[1]);
  reader.join();
  close(ends[0]);
  EXPECT_EQ(received, read_text(directory / "file"));
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
  Field field = field_of({1, 1, 1}, [](auto, auto, auto) { return 1.0; });
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
  Field field = field_of({1, 1, 1}, [](auto, auto, auto) { return 1.0; });
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
  Field field = field_of({2, 1, 1}, [](auto, auto, auto) { return 1.0; });
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
  const Field field = ball_field();
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

// --- read_vdb_lattice

// As another program would write it.
VdbGridToWrite named_grid(const std::string& name, const VdbTransform& transform) {
  return {name, transform, {{-5, 2, 30}, {4, 2, 100}}};
}

std::string input_error_of(const std::string& path, const std::string& name) {
  try {
    (void)read_vdb_lattice(path, name);
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no InputError";
  return {};
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
  const Field field = ball_field();  // zero at its borders
  write_vdb(directory / "out.vdb", field);
  expect_same(read_vdb_lattice(directory / "out.vdb", ""), field.lattice);
  expect_same(read_vdb_lattice(directory / "out.vdb", "winding"), field.lattice);
}

TEST(ReadVdbLattice, ReturnsTheRecordedLatticeOfAnEmptyGrid) {
  const TemporaryDirectory directory;
  const Field field = field_of({4, 5, 6}, [](auto, auto, auto) { return 0.0; });
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
  const Field field = field_of({9, 9, 9}, [](auto x, auto y, auto z) { return static_cast<double>(x + y + z); });
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
