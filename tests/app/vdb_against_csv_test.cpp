// The whole pipeline, twice: every voxel of the OpenVDB file equals the value in the CSV, at the world position in the
// CSV.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/app/csv_numbers.h"
#include "tests/app/meshes.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/vdb_files.h"

namespace raycone::test {
namespace {

void compare(const std::string& mesh, const std::vector<std::string>& options) {
  const TemporaryDirectory dir;
  const std::string path = dir / "mesh.obj";
  write_text(path, mesh);
  for (const std::string name : {"out.csv", "out.vdb"}) {
    ASSERT_EQ(run_raycone(with_more({"lattice", path, "-o", dir / name}, options)).status, 0);
  }
  const CsvNumbers csv = csv_numbers(read_text(dir / "out.csv"));
  EXPECT_EQ(csv.names, (std::vector<std::string>{"i", "j", "k", "x", "y", "z", "w"}));
  const VdbGridPtr grid = read_vdb_grid(dir / "out.vdb", "winding");
  ASSERT_TRUE(grid);
  ASSERT_GT(csv.rows.size(), 100U);
  std::uint64_t active = 0;
  for (const std::vector<double>& row : csv.rows) {
    const VoxelIndex at = voxel_of(row);
    const auto w = static_cast<float>(row[6]);
    EXPECT_EQ(grid->value(at), w);
    EXPECT_EQ(grid->is_active(at), w != grid->background());
    active += grid->is_active(at);
    const Vec3 world = grid->position(at), expected{row[3], row[4], row[5]};
    EXPECT_LE(largest_coordinate(world - expected), 1e-12);  // some roundings of values below 10
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
