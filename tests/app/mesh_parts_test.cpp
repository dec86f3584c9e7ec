// Meshes that are read a second time are the same as at first.
#include "app/input/mesh_parts.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "io/files/file_error.h"
#include "tests/app/meshes.h"
#include "tests/support/bytes.h"
#include "tests/support/temporary_directory.h"

namespace raycone::test {
namespace {

// So many unconnected triangles.
void write_stl(const std::string& path, std::uint32_t triangles) {
  std::string bytes = std::string(80, '\0') + bytes_of({triangles});
  for (std::uint32_t n = 0; n < triangles; ++n) {
    const auto at = static_cast<float>(n);
    bytes += bytes_of<float>({0, 0, 1, at, 0, 0, at, 1, 0, at, 0, 1}) + std::string(2, '\0');
  }
  write_text(path, bytes);
}

TEST(MeshParts, BuffersThatChangedBetweenTwoReadingsAreNoticed) {
  const TemporaryDirectory directory;
  write_stl(directory / "a.stl", 800'000);  // larger than what is kept: the next one is read again
  write_text(directory / "b.gltf", gltf_of("b.bin"));
  write_text(directory / "b.bin", triangle_corners(1));
  MeshOptions options;
  options.path = directory / "a.stl";
  options.further = {directory / "b.gltf"};
  options.parts.by = PartsBy::kFile;
  const RunLimits limits(RunOptions{}, options.path);
  MeshParts parts(options, limits, WholeMesh::kUnused);
  std::vector<Warning> warnings;
  EXPECT_EQ(parts.part(1, warnings).triangles.size(), 1U);
  write_text(directory / "b.bin", triangle_corners(2));
  EXPECT_THROW((void)parts.part(1, warnings), InputError);
}

}  // namespace
}  // namespace raycone::test
