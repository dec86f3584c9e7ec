// Grids of the several kinds of fields, and several of them in one file.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "io/fields/field_writer.h"
#include "io/files/half.h"
#include "tests/support/output_checks.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/text_files.h"
#include "tests/support/vdb_files.h"

namespace raycone {
namespace {

using test::read_text;
using test::read_vdb_grid, test::VdbClass, test::VdbGridPtr, test::VdbType, test::VoxelIndex;
using test::TemporaryDirectory;

constexpr double kVoxel = 0.1;

const FieldDescription kInside{"inside", "inside", "inside", FieldKind::kFlag, 0.0, "threshold=0.5"};
const FieldDescription kDensity{"density", "density", "density", FieldKind::kDensity, 0.0, ""};
const FieldDescription kDistance{"sdf", "sdf", "surface", FieldKind::kDistance, 3 * kVoxel, "threshold=0.5"};

Lattice lattice_around_zero() { return {{0, 0, 0}, {kVoxel, kVoxel, kVoxel}, {-30, -30, -30}, {61, 61, 61}}; }

double radius_of(const VoxelIndex& at) { return kVoxel * std::sqrt(at.x * at.x + at.y * at.y + at.z * at.z); }

// A ball of radius 2: its signed distance clamped to three voxels.
double distance_at(const VoxelIndex& at) { return std::clamp(radius_of(at) - 2.0, -3 * kVoxel, 3 * kVoxel); }

template <class Visit>
void for_each_voxel(const Lattice& lattice, const Visit& visit) {
  for_each_sample(whole(lattice), [&](const LatticeIndex& index) {
    const auto& [i, j, k] = index;
    visit(VoxelIndex{static_cast<int>(i), static_cast<int>(j), static_cast<int>(k)});
  });
}

template <class Function>
auto samples_of(const Lattice& lattice, const Function& function) {
  std::vector<decltype(function(VoxelIndex()))> numbers;
  for_each_voxel(lattice, [&](const VoxelIndex& at) { numbers.push_back(function(at)); });
  return numbers;
}

void write_vdb(const std::string& path, const OutputDescription& description, const std::vector<FieldValues>& fields) {
  OutputFile output(path);
  const auto writer = make_lattice_writer(FieldFormat::kVdb, output, lattice_around_zero(), description);
  writer->write(whole(lattice_around_zero()), fields);
  writer->finish({});
}

VdbGridPtr written_ball(const OutputDescription& description, VdbType type = VdbType::kFloat) {
  const TemporaryDirectory directory;
  const auto distances = samples_of(lattice_around_zero(), distance_at);
  write_vdb(directory / "out.vdb", description, {std::span(distances)});
  return read_vdb_grid(directory / "out.vdb", "surface", type);
}

OutputDescription described(const std::vector<FieldDescription>& fields) {
  OutputDescription description;
  description.fields = fields;
  return description;
}

TEST(WriteVdbFields, HoldsEveryFieldUnderItsName) {
  const TemporaryDirectory directory;
  const Lattice lattice = lattice_around_zero();
  const auto inside = samples_of(lattice, [](const auto& at) { return std::uint8_t(radius_of(at) <= 2.0); });
  const auto density = samples_of(lattice, [](const auto& at) { return std::clamp(2.5 - radius_of(at), 0.0, 1.0); });
  const auto distances = samples_of(lattice, distance_at);
  write_vdb(directory / "out.vdb", described({kInside, kDensity, kDistance}),
            {std::span(inside), std::span(density), std::span(distances)});
  const auto bools = read_vdb_grid(directory / "out.vdb", "inside", VdbType::kBool);
  const auto fog = read_vdb_grid(directory / "out.vdb", "density");
  const auto surface = read_vdb_grid(directory / "out.vdb", "surface");
  ASSERT_TRUE(bools && fog && surface);
  EXPECT_EQ(bools->grid_class(), VdbClass::kUnknown);
  EXPECT_EQ(fog->grid_class(), VdbClass::kFogVolume);
  EXPECT_EQ(surface->grid_class(), VdbClass::kLevelSet);
  EXPECT_EQ(bools->text("raycone_rule"), "threshold=0.5");
  EXPECT_EQ(surface->text("raycone_field"), "sdf");
  EXPECT_FALSE(fog->has_metadata("raycone_rule"));
  std::size_t n = 0;
  for_each_voxel(lattice, [&](const VoxelIndex& at) {
    EXPECT_EQ(bools->value(at), inside[n] != 0 ? 1 : 0) << at;
    EXPECT_EQ(bools->is_active(at), inside[n] != 0) << at;
    EXPECT_EQ(fog->value(at), static_cast<float>(density[n])) << at;
    ++n;
  });
}

// Distances of a lattice whose leaves are cut, in blocks where some are below `band`; a third of the blocks are inside,
// a third at random.
struct RandomDistances {
  RandomDistances(const Lattice& lattice, std::uint32_t seed, double band) : random(seed) {
    blocks.reset(whole(lattice), band);
    const LatticeBlock places = blocks.blocks();
    for_each_sample(places, [&](const LatticeIndex& place) {
      side_of_block.push_back(static_cast<int>(random() % 3));
      if (random() % 3 != 0) return;
      for (double& number : blocks.add(place)) number = std::min(band, 1.5 * band * uniform());
    });
    for_each_voxel(lattice, [&](const VoxelIndex& at) {
      const LatticeIndex sample{at.x, at.y, at.z};
      const int side = side_of_block[places.number_of({at.x >> 3, at.y >> 3, at.z >> 3})];
      inside.push_back(side == 2 ? random() % 2 : static_cast<std::uint8_t>(side));
      numbers.push_back(inside.back() != 0 ? -blocks.at(sample) : blocks.at(sample));
    });
  }
  double uniform() { return static_cast<double>(random()) * 0x1p-32; }

  std::mt19937 random;
  std::vector<int> side_of_block;
  DistanceBlocks blocks;
  std::vector<std::uint8_t> inside;
  std::vector<double> numbers;
};

TEST(WriteVdbFields, BlocksOfDistancesMakeTheSameFile) {
  const TemporaryDirectory directory;
  std::uint32_t seed = 0;
  for (const auto precision : {Precision::kHalf, Precision::kSingle, Precision::kDouble}) {
    for (const Lattice& lattice : {Lattice{{0, 0, 0}, {0.1, 0.1, 0.1}, {-13, 3, -1}, {30, 41, 27}},
                                   Lattice{{0, 0, 0}, {0.1, 0.1, 0.1}, {-8, 0, 8}, {24, 32, 16}},
                                   Lattice{{0, 0, 0}, {0.1, 0.1, 0.1}, {5, 5, 5}, {1, 1, 1}}}) {
      OutputDescription description = described({kDistance});
      description.precision = precision;
      const RandomDistances distances(lattice, ++seed, kDistance.background);
      for (const bool by_blocks : {false, true}) {
        OutputFile output(directory / (by_blocks ? "blocks.vdb" : "numbers.vdb"));
        const auto writer = make_lattice_writer(FieldFormat::kVdb, output, lattice, description);
        const FieldValues numbers = std::span<const double>(distances.numbers);
        EXPECT_TRUE(writer->takes_blocks());
        if (by_blocks) {
          writer->write_blocks({distances.blocks, distances.inside});
        } else {
          writer->write(whole(lattice), {&numbers, 1});
        }
        writer->finish({});
      }
      EXPECT_EQ(read_text(directory / "blocks.vdb"), read_text(directory / "numbers.vdb"));
    }
  }
}

// A rule may hold where the winding number is 0: what differs from the value far away is then outside.
TEST(WriteVdbFields, FlagsThatHoldFarAwayAreTheBackground) {
  const TemporaryDirectory directory;
  const auto inside =
      samples_of(lattice_around_zero(), [](const auto& at) { return std::uint8_t(radius_of(at) > 2.0); });
  FieldDescription field = kInside;
  field.background = 1.0;
  write_vdb(directory / "out.vdb", described({field}), {std::span(inside)});
  const auto grid = read_vdb_grid(directory / "out.vdb", "inside", VdbType::kBool);
  EXPECT_EQ(grid->background(), 1);
  EXPECT_EQ(grid->value({1000, 0, 0}), 1);
  std::size_t n = 0;
  for_each_voxel(lattice_around_zero(), [&](const VoxelIndex& at) {
    EXPECT_EQ(grid->value(at), inside[n] != 0 ? 1 : 0) << at;
    EXPECT_EQ(grid->is_active(at), inside[n] == 0) << at;
    ++n;
  });
}

// By way of a float this number would lie in the middle between two halves, and go to the wrong one.
TEST(WriteVdbFields, HalvesAreRoundedOnce) {
  const TemporaryDirectory directory;
  const auto numbers = samples_of(lattice_around_zero(), [](const auto&) { return 1.0 + 0x1p-11 + 0x1p-30; });
  OutputDescription description = described({kDensity});
  description.precision = Precision::kHalf;
  write_vdb(directory / "out.vdb", description, {std::span(numbers)});
  EXPECT_EQ(read_vdb_grid(directory / "out.vdb", "density")->value({0, 0, 0}), 1.0 + 0x1p-10);
}

TEST(WriteVdbFields, LevelSetsAreActiveExactlyInTheBand) {
  const auto grid = written_ball(described({kDistance}));
  for_each_voxel(lattice_around_zero(), [&](const VoxelIndex& at) {
    const double distance = distance_at(at);
    const bool active = std::abs(distance) < 3 * kVoxel;
    const double value = grid->value(at);
    EXPECT_EQ(grid->is_active(at), active) << at;
    EXPECT_NEAR(value, distance, 3e-8) << at;  // half a unit in the last place of 0.3, and that of the background
    EXPECT_EQ(std::abs(value) == grid->background(), !active) << at;
  });
  EXPECT_EQ(grid->value({1000, 0, 0}), grid->background());
}

TEST(WriteVdbFields, LevelSetsOfHalvesAreActiveWhereTheyAreNotTheBackground) {
  const TemporaryDirectory directory;
  const auto distances = samples_of(lattice_around_zero(), distance_at);
  OutputDescription description = described({kDistance});
  description.precision = Precision::kHalf;
  write_vdb(directory / "out.vdb", description, {std::span(distances)});
  const auto grid = read_vdb_grid(directory / "out.vdb", "surface");
  std::size_t close = 0;
  for_each_voxel(lattice_around_zero(), [&](const VoxelIndex& at) {
    const double distance = std::abs(distance_at(at)), value = std::abs(grid->value(at));
    close += grid->is_active(at) && static_cast<double>(nearest_half(distance)) >= grid->background();
    EXPECT_EQ(grid->is_active(at), distance < 3 * kVoxel) << at;
    EXPECT_EQ(value == grid->background(), !grid->is_active(at)) << at;
  });
  EXPECT_GT(close, 0U);  // the nearest half would have been the background
}

TEST(WriteVdbFields, LevelSetsPassOpenvdbsChecks) {
  for (const double voxel : {0.1, 1.0 / 3, 0.7, 1.1, 123.456, 0.0123}) {  // 3 voxels round up or down to a float
    const TemporaryDirectory directory;
    Lattice lattice = lattice_around_zero();
    lattice.spacing = {voxel, voxel, voxel};
    auto distances = samples_of(lattice, distance_at);
    for (double& distance : distances) distance *= voxel / kVoxel;
    FieldDescription field = kDistance;
    field.background = 3 * voxel;
    {
      OutputFile output(directory / "out.vdb");
      const auto writer = make_lattice_writer(FieldFormat::kVdb, output, lattice, described({field}));
      const FieldValues values = std::span(distances);
      writer->write(whole(lattice), {&values, 1});
      writer->finish({});
    }
    EXPECT_EQ(read_vdb_grid(directory / "out.vdb", "surface")->level_set_faults(9), "") << voxel;
  }
}

TEST(WriteVdbFields, InteriorsOfLevelSetsAreInactiveTiles) {
  const auto grid = written_ball(described({kDistance}));
  EXPECT_EQ(grid->active_tile_count(), 0U);
  EXPECT_FALSE(grid->has_leaf({0, 0, 0}));
  EXPECT_EQ(grid->value({0, 0, 0}), -grid->background());
  EXPECT_EQ(grid->value_depth({0, 0, 0}), 2) << "a tile of 8^3 voxels";
}

// The largest double below the band is the band as a float: still not the background.
TEST(WriteVdbFields, DistancesThatRoundToTheBandStayActive) {
  const TemporaryDirectory directory;
  const auto distances = samples_of(lattice_around_zero(), [](const VoxelIndex& at) {
    const double below = std::nextafter(3 * kVoxel, 0.0);
    return at.x == 5 ? below : at.x == 6 ? -below : 3 * kVoxel;
  });
  write_vdb(directory / "out.vdb", described({kDistance}), {std::span(distances)});
  const auto grid = read_vdb_grid(directory / "out.vdb", "surface");
  EXPECT_EQ(grid->active_voxel_count(), 2U * 61 * 61);
  EXPECT_EQ(grid->level_set_faults(8), "");
}

// docs/formats.md: whatever the type, a number is on the side where its double is.
TEST(WriteVdbFields, DistancesKeepTheSideOfInside) {
  const TemporaryDirectory directory;
  const auto inside = samples_of(lattice_around_zero(), [](const auto& at) { return std::uint8_t(at.x < 0); });
  const auto distances = samples_of(lattice_around_zero(), [](const VoxelIndex& at) {
    constexpr std::array kSizes{5e-324, 1e-300, 1e-50, 1e-46, 1e-40, 1e-12, 2.9e-8, 1e-7, 0.05};
    const double size = kSizes[static_cast<std::size_t>(at.y + 30) % kSizes.size()];
    return at.x < 0 ? -size : size;
  });
  for (const auto precision : {Precision::kHalf, Precision::kSingle, Precision::kDouble}) {
    OutputDescription description = described({kInside, kDistance});
    description.precision = precision;
    write_vdb(directory / "out.vdb", description, {std::span(inside), std::span(distances)});
    const VdbType type = precision == Precision::kDouble ? VdbType::kDouble : VdbType::kFloat;
    const auto flags = read_vdb_grid(directory / "out.vdb", "inside", VdbType::kBool);
    const auto grid = read_vdb_grid(directory / "out.vdb", "surface", type);
    std::size_t wrong = 0, inactive = 0;
    for_each_voxel(lattice_around_zero(), [&](const VoxelIndex& at) {
      wrong += (grid->value(at) < 0) != (flags->value(at) != 0);
      inactive += !grid->is_active(at);
    });
    EXPECT_EQ(wrong, 0U) << static_cast<int>(precision);
    EXPECT_EQ(inactive, 0U) << static_cast<int>(precision);
  }
}

TEST(WriteVdbFields, DoublesOnRequest) {
  OutputDescription description = described({kDistance});
  description.precision = Precision::kDouble;
  const auto grid = written_ball(description, VdbType::kDouble);
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->background(), 3 * kVoxel);
  EXPECT_EQ(grid->value({19, 0, 0}), distance_at({19, 0, 0}));
}

TEST(WriteVdbFields, PyopenvdbReadsThem) {
  if (!test::python_has("pyopenvdb")) GTEST_SKIP() << "no pyopenvdb in /usr/bin/python3";
  const TemporaryDirectory directory;
  const auto inside =
      samples_of(lattice_around_zero(), [](const auto& at) { return std::uint8_t(radius_of(at) <= 2.0); });
  const auto distances = samples_of(lattice_around_zero(), distance_at);
  write_vdb(directory / "out.vdb", described({kInside, kDistance}), {std::span(inside), std::span(distances)});
  EXPECT_EQ(test::run_python("import pyopenvdb, sys\n"
                             "grids, _ = pyopenvdb.readAll(sys.argv[1])\n"
                             "assert [(g.name, type(g).__name__) for g in grids] == "
                             "[('inside', 'BoolGrid'), ('surface', 'FloatGrid')]\n"
                             "inside, surface = grids\n"
                             "assert surface.gridClass == pyopenvdb.GridClass.LEVEL_SET\n"
                             "assert inside.getConstAccessor().getValue((0, 0, 0)) is True\n"
                             "assert surface.getConstAccessor().getValue((0, 0, 0)) < -0.29\n",
                             {directory / "out.vdb"}),
            "");
}

}  // namespace
}  // namespace raycone
