// The grids of diagnostics beside that of the field.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "core/data/lattice_slabs.h"
#include "io/fields/field_writer.h"
#include "io/vdb/read_vdb.h"
#include "tests/support/output_checks.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/text_files.h"
#include "tests/support/vdb_files.h"

namespace raycone {
namespace {

using test::read_text;
using test::read_vdb_grids, test::VdbGrid, test::VdbGridPtr, test::VdbType;
using test::TemporaryDirectory;

struct DiagnosedField {
  Lattice lattice;
  std::vector<double> values;
  std::vector<std::int64_t> crossings, degenerate;
  std::vector<std::uint8_t> on_surface;
  std::vector<double> error_bound;
};

// Indices start and end inside leaf blocks, on either side of 0. The lower half is noise, the upper half constant, so
// that there are leaves, tiles and nothing.
DiagnosedField diagnosed_field() {
  DiagnosedField field;
  field.lattice = {{0.1, -20.7, 1e-3}, {0.1, 0.3, 1.0 / 3}, {-13, -3, -21}, {29, 18, 44}};
  std::mt19937_64 random(1);
  for (std::int64_t n = 0; n < 29 * 18 * 44; ++n) {
    const bool constant = n >= 29 * 18 * 22;
    field.values.push_back(constant ? 1.0 : static_cast<double>(random() % 1000) / 999);
    field.crossings.push_back(constant ? -2 : static_cast<std::int64_t>(random() % 7) - 3);
    field.degenerate.push_back(constant ? 0 : static_cast<std::int64_t>(random() % 3));
    field.on_surface.push_back(constant || random() % 4 == 0 ? 1 : 0);
    field.error_bound.push_back(constant ? 0.0 : static_cast<double>(random() % 1000) * 1.1e-17);
  }
  field.error_bound[5] = 5e-324;  // 0 in single precision, were it not rounded up
  return field;
}

void write_vdb(const std::string& path, const DiagnosedField& field, std::int64_t thickness = 8) {
  OutputFile output(path);
  OutputDescription description = test::described_with_diagnostics();
  description.mesh = "bunny.obj";
  const auto writer = make_lattice_writer(FieldFormat::kVdb, output, field.lattice, description);
  for (std::int64_t done = 0; done < field.lattice.counts[2]; done += thickness) {
    const LatticeBlock slab = slab_of(whole(field.lattice), 2, done, thickness);
    const auto of_slab = [&](const auto& numbers) { return test::part(field.lattice, numbers, slab); };
    const auto values = of_slab(field.values), error_bound = of_slab(field.error_bound);
    const auto crossings = of_slab(field.crossings), degenerate = of_slab(field.degenerate);
    const auto on_surface = of_slab(field.on_surface);
    writer->write(slab, std::vector<FieldValues>{std::span(values), std::span(crossings), std::span(degenerate),
                                                 std::span(on_surface), std::span(error_bound)});
  }
  writer->finish({7, 9});
}

// Null where it is not of that type.
VdbGridPtr grid_named(const std::vector<VdbGridPtr>& grids, const std::string& name, VdbType type = VdbType::kFloat) {
  const auto found = std::ranges::find_if(grids, [&](const VdbGridPtr& grid) { return grid->name() == name; });
  return found != grids.end() && (*found)->type() == type ? *found : nullptr;
}

// Every voxel of the lattice, and one layer around it, is check(number, value) and active where it is not 0.
template <typename Number, typename Check>
void expect_holds(const VdbGrid& grid, const Lattice& lattice, const std::vector<Number>& numbers, const Check& check) {
  std::size_t active = 0;
  const auto inside = [&](std::int64_t n, std::size_t axis) { return 0 <= n && n < lattice.counts[axis]; };
  for (std::int64_t z = -1; z <= lattice.counts[2]; ++z) {
    for (std::int64_t y = -1; y <= lattice.counts[1]; ++y) {
      for (std::int64_t x = -1; x <= lattice.counts[0]; ++x) {
        const bool sample = inside(x, 0) && inside(y, 1) && inside(z, 2);
        const auto n = static_cast<std::size_t>((z * lattice.counts[1] + y) * lattice.counts[0] + x);
        const Number number = sample ? numbers[n] : Number{0};
        const test::VoxelIndex at{static_cast<int>(lattice.index_min[0] + x),
                                  static_cast<int>(lattice.index_min[1] + y),
                                  static_cast<int>(lattice.index_min[2] + z)};
        ASSERT_TRUE(check(number, grid.value(at))) << at << ": " << +number << ' ' << grid.value(at);
        ASSERT_EQ(grid.is_active(at), number != 0) << at;
        active += number != 0 ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(grid.active_voxel_count(), active);
  EXPECT_GT(active, 0U);
}

TEST(WriteVdbDiagnostics, EveryVoxelOfEveryGridIsTheSamples) {
  const TemporaryDirectory directory;
  const DiagnosedField field = diagnosed_field();
  write_vdb(directory / "out.vdb", field);
  const auto grids = read_vdb_grids(directory / "out.vdb");
  ASSERT_EQ(grids.size(), 5U);
  const auto equal = [](auto number, double value) { return static_cast<float>(number) == value; };
  const auto grid = [&](const std::string& name) { return grid_named(grids, name); };
  expect_holds(*grid("winding"), field.lattice, field.values, equal);
  expect_holds(*grid("crossings"), field.lattice, field.crossings, equal);
  expect_holds(*grid("degenerate"), field.lattice, field.degenerate, equal);
  expect_holds(*grid_named(grids, "on_surface", VdbType::kBool), field.lattice, field.on_surface, equal);
  expect_holds(*grid("error_bound"), field.lattice, field.error_bound, [](double bound, double value) {
    const double below = std::nextafter(static_cast<float>(value), -1.0F);
    return value >= bound && (bound == 0 ? value == 0 : below < bound);
  });
}

TEST(WriteVdbDiagnostics, GridsShareTransformAndDescription) {
  const TemporaryDirectory directory;
  const DiagnosedField field = diagnosed_field();
  write_vdb(directory / "out.vdb", field);
  const auto grids = read_vdb_grids(directory / "out.vdb");
  for (const VdbGridPtr& grid : grids) {
    EXPECT_TRUE(grid->has_transform_of(*grids.front()));
    EXPECT_EQ(grid->text("raycone_field"), grid->name());
    EXPECT_EQ(grid->text("raycone_mesh"), "bunny.obj");
    EXPECT_EQ(grid->integer("raycone_degenerate"), 7);
    const Lattice lattice = read_vdb_lattice(directory / "out.vdb", grid->name()).grid;
    EXPECT_EQ(lattice.origin, field.lattice.origin);
    EXPECT_EQ(lattice.spacing, field.lattice.spacing);
    EXPECT_EQ(lattice.index_min, field.lattice.index_min);
    EXPECT_EQ(lattice.counts, field.lattice.counts);
  }
}

TEST(WriteVdbDiagnostics, ConstantBlocksAreTiles) {
  const TemporaryDirectory directory;
  DiagnosedField field = diagnosed_field();
  field.lattice.index_min = {-16, 0, 8};
  field.lattice.counts = {16, 16, 16};
  field.values.assign(4096, 1.0);
  field.crossings.assign(4096, 1);
  field.degenerate.assign(4096, 0);
  field.on_surface.assign(4096, 1);
  field.error_bound.assign(4096, 0.0);
  write_vdb(directory / "out.vdb", field);
  const auto grids = read_vdb_grids(directory / "out.vdb");
  const auto crossings = grid_named(grids, "crossings");
  const auto on_surface = grid_named(grids, "on_surface", VdbType::kBool);
  EXPECT_EQ(crossings->leaf_count() + on_surface->leaf_count(), 0U);
  EXPECT_EQ(crossings->active_tile_count(), 8U);
  EXPECT_EQ(on_surface->active_tile_count(), 8U);
  EXPECT_TRUE(grid_named(grids, "degenerate")->is_empty());
  EXPECT_TRUE(grid_named(grids, "error_bound")->is_empty());
}

TEST(WriteVdbDiagnostics, DependNotOnTheSlabs) {
  const TemporaryDirectory directory;
  write_vdb(directory / "aligned", diagnosed_field(), 44);
  for (const std::int64_t thickness : {1, 3, 8, 13}) {
    write_vdb(directory / "other", diagnosed_field(), thickness);
    EXPECT_EQ(read_text(directory / "other"), read_text(directory / "aligned")) << thickness;
  }
}

TEST(WriteVdbDiagnostics, PyopenvdbReadsAllGrids) {
  if (!test::python_has("pyopenvdb, numpy")) GTEST_SKIP() << "no pyopenvdb and numpy in /usr/bin/python3";
  const TemporaryDirectory directory;
  const DiagnosedField field = diagnosed_field();
  write_vdb(directory / "out.vdb", field);
  const auto on_surface = std::count(field.on_surface.begin(), field.on_surface.end(), 1);
  EXPECT_EQ(test::run_python("import numpy, pyopenvdb, sys\n"
                             "grids, _ = pyopenvdb.readAll(sys.argv[1])\n"
                             "types = {grid.name: type(grid).__name__ for grid in grids}\n"
                             "assert types == dict(winding='FloatGrid', crossings='FloatGrid', degenerate='FloatGrid',"
                             " on_surface='BoolGrid', error_bound='FloatGrid'), types\n"
                             "grid = pyopenvdb.read(sys.argv[1], 'on_surface')\n"
                             "flags = numpy.empty((29, 18, 44), bool)\n"
                             "grid.copyToArray(flags, ijk=grid.metadata['raycone_index_min'])\n"
                             "assert flags.sum() == grid.activeVoxelCount() == int(sys.argv[2])\n",
                             {directory / "out.vdb", std::to_string(on_surface)}),
            "");
}

}  // namespace
}  // namespace raycone
