// `--field` and `--rule` from mesh to files. Black box: the real executable.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/app/csv_numbers.h"
#include "tests/app/meshes.h"
#include "tests/support/output_checks.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/vdb_files.h"

namespace raycone::test {
namespace {

class FieldOption : public testing::Test {
 protected:
  FieldOption() {
    // Overlapping, nested and reversed: winding numbers from -1 to 3, all values between, and exact halves.
    write_text(soup_, triangle_soup(40));
    write_text(cubes_, std::string(kCube) + "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\n");
  }

  CommandResult run(const std::string& mesh, const std::string& output, const std::vector<std::string>& more) const {
    return run_raycone(with_more({"lattice", mesh, "-o", output, "--resolution", "13", "--padding", "2v"}, more));
  }

  TemporaryDirectory dir_;
  std::string soup_ = dir_ / "soup.obj";
  std::string cubes_ = dir_ / "cubes.obj";
};

TEST_F(FieldOption, EveryRuleSaysWhatTheWindingNumberSays) {
  const auto integer = [](double w) { return std::floor(w + 0.5); };
  const std::map<std::string, std::function<bool(double)>> rules{
      {"threshold=0.5", [](double w) { return w >= 0.5; }},
      {"threshold=-.1", [](double w) { return w >= -0.1; }},
      {"abs=0.25", [](double w) { return std::abs(w) >= 0.25; }},
      {"nonzero", [&](double w) { return integer(w) != 0; }},
      {"positive", [&](double w) { return integer(w) > 0; }},
      {"odd", [&](double w) { return std::fmod(integer(w), 2) != 0; }}};
  for (const auto& [rule, holds] : rules) {
    std::ptrdiff_t insides = 0, samples = 0;
    for (const std::string& mesh : {soup_, cubes_}) {
      const CsvNumbers csv = csv_numbers(run(mesh, "-", {"--field", "inside,winding", "--rule", rule}).out);
      const std::vector<double> inside = csv.column("inside"), w = csv.column("w");
      ASSERT_GT(w.size(), 2000U);
      for (std::size_t n = 0; n < w.size(); ++n) ASSERT_EQ(inside[n], holds(w[n]) ? 1 : 0) << rule << ' ' << w[n];
      insides += std::ranges::count(inside, 1.0);
      samples += std::ssize(w);
    }
    EXPECT_GT(insides, 0) << rule;
    EXPECT_LT(insides, samples) << rule;
  }
}

TEST_F(FieldOption, ColumnsComeInTheOrderAskedFor) {
  const auto header = [](const CommandResult& result) { return result.out.substr(0, result.out.find('\n')); };
  EXPECT_EQ(header(run(soup_, "-", {"--field", "inside"})), "i,j,k,x,y,z,inside");
  EXPECT_EQ(header(run(soup_, "-", {"--field", "density,winding,inside", "--diagnostics"})),
            "i,j,k,x,y,z,density,w,inside,crossings,degenerate,on_surface,error_bound");
  write_text(dir_ / "points.csv", "0.5,0.5,0.5\n");
  EXPECT_EQ(run_raycone({"points", cubes_, dir_ / "points.csv", "--field", "inside,density,winding"}).out,
            "x,y,z,inside,density,w\n0.5,0.5,0.5,1,1,1.8333333333333333\n");
}

TEST_F(FieldOption, DensityIsClamped) {
  const CsvNumbers csv = csv_numbers(run(cubes_, "-", {"--field", "density,winding"}).out);
  const std::vector<double> density = csv.column("density"), w = csv.column("w");
  for (std::size_t n = 0; n < w.size(); ++n) ASSERT_EQ(density[n], std::clamp(w[n], 0.0, 1.0));
  EXPECT_GT(std::ranges::max(w), 1.5) << "or nothing is clamped";
}

TEST_F(FieldOption, VdbHoldsAGridPerField) {
  const std::vector<std::string> options{"--field", "inside,winding,density", "--rule", "abs=.3", "--diagnostics"};
  ASSERT_EQ(run(soup_, dir_ / "out.vdb", options).status, 0);
  const CsvNumbers csv = csv_numbers(run(soup_, "-", options).out);
  const std::vector<double> insides = csv.column("inside"), densities = csv.column("density"), w = csv.column("w");
  ASSERT_EQ(read_vdb_grids(dir_ / "out.vdb").size(), 7U);
  const VdbGridPtr inside = read_vdb_grid(dir_ / "out.vdb", "inside", VdbType::kBool);
  const VdbGridPtr density = read_vdb_grid(dir_ / "out.vdb", "density");
  const VdbGridPtr winding = read_vdb_grid(dir_ / "out.vdb", "winding");
  ASSERT_TRUE(inside && density && winding);
  for (const VdbGridPtr& grid : {inside, density, winding}) EXPECT_EQ(grid->text("raycone_rule"), "abs=0.3");
  EXPECT_EQ(density->grid_class(), VdbClass::kFogVolume);
  EXPECT_EQ(winding->grid_class(), VdbClass::kUnknown);
  for (std::size_t n = 0; n < w.size(); ++n) {
    const VoxelIndex at = voxel_of(csv.rows[n]);
    ASSERT_EQ(inside->value(at), insides[n] == 1 ? 1 : 0);
    ASSERT_EQ(inside->is_active(at), insides[n] == 1);
    ASSERT_EQ(density->value(at), static_cast<float>(densities[n]));
    ASSERT_EQ(winding->value(at), static_cast<float>(w[n]));
  }
}

TEST_F(FieldOption, NpyOfALatticeHoldsOneField) {
  const CommandResult result = run(dir_ / "absent.obj", "out.npy", {"--field", "inside,winding"});
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.err, "raycone: several fields: npy holds one number per sample, expected vdb, csv, npz or vti\n");
}

TEST_F(FieldOption, NumpySeesBooleansAndColumns) {
  if (!python_has("numpy")) GTEST_SKIP() << "no numpy in /usr/bin/python3";
  ASSERT_EQ(run(soup_, dir_ / "inside.npy", {"--field", "inside"}).status, 0);
  ASSERT_EQ(run(soup_, dir_ / "w.npy", {"--double"}).status, 0);
  write_text(dir_ / "points.csv", ".5 .5 .5\n.25 .5 .5\n9 9 9\n");
  ASSERT_EQ(run_raycone({"points", cubes_, dir_ / "points.csv", "-o", dir_ / "points.npy", "--field", "winding,inside"})
                .status,
            0);
  ASSERT_EQ(run_raycone({"points", cubes_, dir_ / "points.csv", "-o", dir_ / "one.npy", "--field", "inside"}).status,
            0);
  EXPECT_EQ(run_python("import numpy, sys\n"
                       "load = lambda name: numpy.load(sys.argv[1] + '/' + name + '.npy')\n"
                       "inside, w = load('inside'), load('w')\n"
                       "assert inside.dtype == bool and w.dtype == float and inside.shape == w.shape\n"
                       "assert (inside == (w >= 0.5)).all() and 0 < inside.sum() < inside.size\n"
                       "points, one = load('points'), load('one')\n"
                       "assert points.shape == (3, 2) and points.dtype == float and one.shape == (3,)\n"
                       "assert points[:, 1].tolist() == one.tolist() == [1.0, 1.0, 0.0]\n",
                       {dir_ / ""}),
            "");
}

TEST_F(FieldOption, BytesDoNotDependOnThreads) {
  const auto vdb = [&](const std::string& threads) {
    EXPECT_EQ(run(soup_, dir_ / "out.vdb", {"--field", "inside,density", "--threads", threads}).status, 0);
    return read_text(dir_ / "out.vdb");
  };
  EXPECT_EQ(vdb("1"), vdb("5"));
}

// 2048 samples along the longest side: 8.6e9 of them, in memory that the surface and a slab of eight layers take.
TEST_F(FieldOption, LargeLatticesOfAClosedMeshTakeMemoryOfItsSurface) {
  std::ostringstream flat_box;  // 2048 x 2048 x 17 samples: the layers of the full cube, fewer of them
  flat_box << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 .0078\nv 1 0 .0078\nv 1 1 .0078\nv 0 1 .0078\n"
           << std::string(kCube).substr(std::string(kCube).find('f'));
  write_text(dir_ / "box.obj", flat_box.str());
  const CommandResult result = run_raycone({"lattice", dir_ / "box.obj", "-o", dir_ / "box.vdb", "--resolution", "2048",
                                            "--field", "inside", "--memory-limit", "700M"});
  EXPECT_EQ(result.status, 0) << result.err;
}

TEST_F(FieldOption, RefusesWhatItDoesNotKnow) {
  const std::map<std::vector<std::string>, std::string> refused{
      {{"--field", "colour"},
       "--field colour: expected one or more of winding, inside, density, sdf, solid, gradient, label"},
      {{"--field", "inside,"},
       "--field inside,: expected one or more of winding, inside, density, sdf, solid, gradient, label"},
      {{"--field", "inside,winding,inside"}, "--field inside,winding,inside: expected each field once"},
      {{"--rule", "half"}, "--rule half: expected threshold=T, abs=T, nonzero, positive or odd"},
      {{"--rule", "threshold=inf"}, "--rule threshold=inf: expected threshold=T, abs=T, nonzero, positive or odd"}};
  for (const auto& [options, message] : refused) {
    const CommandResult result = run(dir_ / "absent.obj", "-", options);
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(result.err, "raycone: " + message + "\n");
  }
}

}  // namespace
}  // namespace raycone::test
