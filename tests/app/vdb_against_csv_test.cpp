// The whole pipeline, twice: every voxel of the OpenVDB file equals the value in the CSV, at the world position in the
// CSV.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/app/meshes.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/vdb_files.h"

namespace raycone::test {
namespace {

struct CsvSample {
  VoxelIndex index;
  Vec3 position;
  double value;
};

std::vector<CsvSample> read_csv(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line, "i,j,k,x,y,z,w");
  std::vector<CsvSample> samples;
  while (std::getline(file, line)) {
    std::istringstream row(line);
    CsvSample s;
    char comma = 0;
    row >> s.index.x >> comma >> s.index.y >> comma >> s.index.z;
    row >> comma >> s.position[0] >> comma >> s.position[1] >> comma >> s.position[2] >> comma >> s.value;
    EXPECT_FALSE(row.fail()) << line;
    samples.push_back(s);
  }
  return samples;
}

void compare(const std::string& mesh, const std::vector<std::string>& options) {
  const TemporaryDirectory dir;
  const std::string path = dir / "mesh.obj";
  std::ofstream(path) << mesh;
  for (const std::string name : {"out.csv", "out.vdb"}) {
    ASSERT_EQ(run_raycone(with_more({"lattice", path, "-o", dir / name}, options)).status, 0);
  }
  const std::vector<CsvSample> samples = read_csv(dir / "out.csv");
  const VdbGridPtr grid = read_vdb_grid(dir / "out.vdb", "winding");
  ASSERT_TRUE(grid);
  ASSERT_GT(samples.size(), 100U);
  std::uint64_t active = 0;
  for (const CsvSample& s : samples) {
    EXPECT_EQ(grid->value(s.index), static_cast<float>(s.value));
    EXPECT_EQ(grid->is_active(s.index), static_cast<float>(s.value) != grid->background());
    active += grid->is_active(s.index);
    const Vec3 world = grid->position(s.index);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(world[axis], s.position[axis], 1e-12);  // some roundings of values below 10
  }
  EXPECT_EQ(grid->active_voxel_count(), active);  // nothing beside the samples
}

TEST(VdbAgainstCsv, ClosedMesh) { compare(kCube, {"--resolution", "20", "--padding", "3v"}); }

TEST(VdbAgainstCsv, ClosedMeshWithAnisotropicVoxelsAndNegativeIndices) {
  compare(kCube, {"--voxel-size", ".11,.07,.05", "--padding", ".3"});
}

TEST(VdbAgainstCsv, OpenMesh) { compare(triangle_soup(20), {"--resolution", "17,9,23"}); }

TEST(VdbAgainstCsv, FlatMesh) { compare(kTriangle, {"--resolution", "30"}); }

}  // namespace
}  // namespace raycone::test
