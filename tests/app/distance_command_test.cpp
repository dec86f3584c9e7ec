// `--field sdf` from mesh to files. Black box: the real executable.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/exact/direct_distance.h"
#include "io/mesh/read_mesh.h"
#include "tests/app/csv_numbers.h"
#include "tests/app/meshes.h"
#include "tests/support/output_checks.h"
#include "tests/support/run_command.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/vdb_files.h"

namespace raycone::test {
namespace {

VdbGridPtr surface_of(const std::string& path) { return read_vdb_grid(path, "surface"); }

struct Sample {
  VoxelIndex index;
  Vec3 position;
  double w, distance;
};

std::vector<Sample> samples_of(const std::string& csv) {
  const CsvNumbers numbers = csv_numbers(csv);
  EXPECT_EQ(numbers.names, (std::vector<std::string>{"i", "j", "k", "x", "y", "z", "w", "sdf"}));
  std::vector<Sample> samples;
  for (const std::vector<double>& row : numbers.rows) {
    samples.push_back({voxel_of(row), {row[3], row[4], row[5]}, row[6], row[7]});
  }
  return samples;
}

class SdfField : public testing::Test {
 protected:
  SdfField() {
    write_text(cube_, kCube);
    write_text(soup_, triangle_soup(25));
  }

  CommandResult lattice(const std::string& mesh, const std::string& output,
                        const std::vector<std::string>& more) const {
    return run_raycone(with_more({"lattice", mesh, "-o", output, "--quiet"}, more));
  }

  TemporaryDirectory dir_;
  std::string cube_ = dir_ / "cube.obj";
  std::string soup_ = dir_ / "soup.obj";
};

TEST_F(SdfField, IsTheDistanceToTheTrianglesWithTheSignOfTheRule) {
  const std::map<std::string, bool (*)(double)> rules{{"threshold=0.5", [](double w) { return w >= 0.5; }},
                                                      {"abs=0.2", [](double w) { return std::abs(w) >= 0.2; }}};
  for (const std::string& path : {cube_, soup_}) {
    const TriangleMesh mesh = read_mesh(path, {}).parsed.mesh;
    for (const auto& [rule, inside] : rules) {
      const auto samples = samples_of(
          lattice(path, "-", {"--field", "winding,sdf", "--resolution", "16", "--rule", rule, "--band", "2.5"}).out);
      const double voxel = samples[1].position.x - samples[0].position.x, band = 2.5 * voxel;
      ASSERT_GT(samples.size(), 5000U);
      for (const Sample& s : samples) {
        const double expected = std::min(static_cast<double>(direct_distance(mesh, s.position)), band);
        ASSERT_NEAR(std::abs(s.distance), expected, 1e-12 * voxel + 1e-15) << s.index;
        ASSERT_TRUE(s.distance == 0 || (s.distance < 0) == inside(s.w)) << s.index << s.w;
      }
    }
  }
}

// To 1e-5 voxels, as floats are.
TEST_F(SdfField, GridHoldsTheSamples) {
  for (const std::string& path : {cube_, soup_}) {
    const std::vector<std::string> options{"--field", "winding,sdf", "--resolution", "20"};
    ASSERT_EQ(lattice(path, dir_ / "out.vdb", options).status, 0);
    const auto grid = surface_of(dir_ / "out.vdb");
    const double voxel = grid->voxel_size().x;
    std::uint64_t active = 0;
    for (const Sample& s : samples_of(lattice(path, "-", options).out)) {
      ASSERT_NEAR(grid->value(s.index), s.distance, 1e-5 * voxel);
      ASSERT_EQ(grid->is_active(s.index), std::abs(s.distance) < 3 * voxel);
      active += grid->is_active(s.index);
    }
    EXPECT_EQ(grid->active_voxel_count(), active);
  }
}

TEST_F(SdfField, IsALevelSetWhateverTheMesh) {
  int checked = 0;
  for (const std::string directory : {RAYCONE_DATA "/meshes", RAYCONE_SHARED_MESHES}) {
    if (!std::filesystem::is_directory(directory)) continue;
    // A batch, since starting a process for each mesh takes longer than the rest.
    std::vector<std::string> arguments{"batch",   "--out-dir",    dir_ / "out", "--full-names", "--field", "sdf",
                                       "--quiet", "--resolution", "14"};
    for (const auto& entry : std::filesystem::directory_iterator(directory)) {
      constexpr std::uintmax_t kQuick = 50'000;  // bytes
      const bool small = entry.is_regular_file() && entry.file_size() < kQuick;
      if (small && mesh_format_from_name(entry.path().extension().string().substr(1)))
        arguments.push_back(entry.path());
    }
    const CommandResult result = run_raycone(arguments);
    ASSERT_TRUE(result.status == 0 || result.status == 5) << result.err;  // some are broken on purpose
    const std::string table = read_text(dir_ / "out/results.csv");
    for (const std::string status : {",crashed,", ",memory,", ",timeout,"})
      EXPECT_EQ(table.find(status), std::string::npos) << table;
    for (const auto& output : std::filesystem::directory_iterator(dir_ / "out")) {
      if (output.path().extension() != ".vdb") continue;
      EXPECT_EQ(surface_of(output.path())->level_set_faults(8), "") << output.path();
      ++checked;
    }
    std::filesystem::remove_all(dir_ / "out");
  }
  EXPECT_GE(checked, 5);  // those of data/meshes
}

TEST_F(SdfField, HasUnitGradientOnSmoothClosedMeshes) {
  write_text(dir_ / "sphere.obj", obj_of(sphere(60)));
  ASSERT_EQ(lattice(dir_ / "sphere.obj", dir_ / "out.vdb", {"--field", "sdf", "--resolution", "40"}).status, 0);
  EXPECT_EQ(surface_of(dir_ / "out.vdb")->level_set_faults(9), "");
}

TEST_F(SdfField, PadsTheBoxByTheBandAndOneVoxel) {
  const auto samples = [&](const std::vector<std::string>& more) {
    const std::string csv = lattice(cube_, "-", with_more({"--field", "sdf", "--resolution", "11"}, more)).out;
    return std::ranges::count(csv, '\n') - 1;
  };
  EXPECT_EQ(samples({}), 19 * 19 * 19);
  EXPECT_EQ(samples({"--band", "1.5"}), 17 * 17 * 17) << "3 voxels";
  EXPECT_EQ(samples({"--padding", "1v"}), 13 * 13 * 13);
  EXPECT_EQ(samples({"--bounds", "0,0,0,1,1,1"}), 11 * 11 * 11);
}

TEST_F(SdfField, OfBandAllIsNotCutOff) {
  const std::vector<std::string> all{"--field", "winding,sdf", "--resolution", "8", "--band", "all"};
  const std::vector<Sample> samples = samples_of(lattice(cube_, "-", all).out);
  EXPECT_EQ(samples.size(), 16U * 16U * 16U) << "padded by 4 voxels";
  const TriangleMesh mesh = read_mesh(cube_).parsed.mesh;
  double farthest = 0.0;
  for (const Sample& s : samples) {
    ASSERT_NEAR(std::abs(s.distance), static_cast<double>(direct_distance(mesh, s.position)), 1e-12);
    ASSERT_EQ(s.distance < 0.0, s.w >= 0.5 && s.distance != 0.0);
    farthest = std::max(farthest, s.distance);
  }
  const double voxel = samples[1].position.x - samples[0].position.x;
  EXPECT_NEAR(farthest, std::sqrt(3.0) * 4 * voxel, 1e-12) << "at the lattice's corners";
  ASSERT_EQ(lattice(cube_, dir_ / "out.vdb", all).status, 0);
  EXPECT_EQ(surface_of(dir_ / "out.vdb")->active_voxel_count(), 16U * 16U * 16U);
}

TEST_F(SdfField, WantsCubicVoxels) {
  const CommandResult result = lattice(cube_, "-", {"--field", "winding,sdf", "--resolution", "11,6,11"});
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.err,
            "raycone: --field sdf: voxels of 0.1 x 0.2 x 0.1, expected cubic ones (--resolution N, --voxel-size H)\n");
  EXPECT_EQ(lattice(cube_, "-", {"--field", "sdf", "--resolution", "5,5,5"}).status, 0);
  EXPECT_EQ(lattice(cube_, "-", {"--field", "sdf", "--voxel-size", ".1,.1,.2"}).status, 1);
  ASSERT_EQ(lattice(cube_, dir_ / "like.vdb", {"--resolution", "5,6,5"}).status, 0);
  EXPECT_EQ(lattice(cube_, "-", {"--field", "sdf", "--like", dir_ / "like.vdb"}).status, 1);
}

TEST_F(SdfField, AtPointsIsNotCutOff) {
  const CommandResult result = run_raycone({"points", cube_, "-", "--field", "sdf", "--quiet"},
                                           {.input = "4 5 1\n.5 .5 .5\n.5 .5 .875\n-1e6 .5 .5\n"});
  EXPECT_EQ(result.out, "x,y,z,sdf\n4,5,1,5\n0.5,0.5,0.5,-0.5\n0.5,0.5,0.875,-0.125\n-1e+06,0.5,0.5,1e+06\n");
}

TEST_F(SdfField, BytesDependOnNeitherThreadsNorFormat) {
  const auto file = [&](const std::string& name, const std::string& threads) {
    EXPECT_EQ(lattice(soup_, dir_ / name, {"--field", "sdf", "--resolution", "30", "--threads", threads}).status, 0);
    return read_text(dir_ / name);
  };
  EXPECT_EQ(file("out.vdb", "1"), file("out.vdb", "6"));
  EXPECT_EQ(file("out.npy", "1"), file("out.npy", "6"));
  if (!python_has("numpy")) GTEST_SKIP() << "no numpy in /usr/bin/python3";
  file("out.csv", "2");
  // The array comes in slabs across x, the table in slabs across z.
  EXPECT_EQ(run_python("import numpy, sys\n"
                       "table = numpy.loadtxt(sys.argv[1] + 'out.csv', delimiter=',', skiprows=1)\n"
                       "array = numpy.load(sys.argv[1] + 'out.npy')\n"
                       "i, j, k = table[:, :3].astype(int).T - table[:, :3].astype(int).min(axis=0)[:, None]\n"
                       "assert (array[i, j, k] == table[:, 6].astype('f4')).all()\n",
                       {dir_ / ""}),
            "");
}

TEST_F(SdfField, BandIsAPositiveNumber) {
  for (const char* const band : {"0", "-1", "many", "inf"}) {
    const CommandResult result = lattice(cube_, "-", {"--field", "sdf", "--band", band});
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(result.err, std::string("raycone: --band ") + band + ": expected a positive number\n");
  }
}

}  // namespace
}  // namespace raycone::test
