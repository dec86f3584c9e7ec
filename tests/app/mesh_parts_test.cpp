// Meshes that are read a second time are the same as at first.
#include "app/input/mesh_parts.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "io/files/file_error.h"
#include "tests/app/meshes.h"
#include "tests/support/temporary_directory.h"

namespace raycone::test {
namespace {

// So many unconnected triangles.
void write_stl(const std::string& path, std::uint32_t triangles) {
  std::string bytes(84, '\0');
  std::memcpy(&bytes[80], &triangles, sizeof triangles);
  for (std::uint32_t n = 0; n < triangles; ++n) {
    const auto at = static_cast<float>(n);
    const float numbers[12] = {0, 0, 1, at, 0, 0, at, 1, 0, at, 0, 1};
    bytes.append(reinterpret_cast<const char*>(numbers), sizeof numbers).append(2, '\0');
  }
  write_text(path, bytes);
}

std::string corners(float size) {
  const float numbers[9] = {0, 0, 0, size, 0, 0, 0, size, 0};
  return {reinterpret_cast<const char*>(numbers), sizeof numbers};
}

constexpr const char* kGltf = R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"scene":0,"scenes":[{"nodes":[0]}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,1]}],
    "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"b.bin"}]})";

TEST(MeshParts, BuffersThatChangedBetweenTwoReadingsAreNoticed) {
  const TemporaryDirectory directory;
  write_stl(directory / "a.stl", 800'000);  // larger than what is kept: the next one is read again
  write_text(directory / "b.gltf", kGltf);
  write_text(directory / "b.bin", corners(1));
  MeshOptions options;
  options.path = directory / "a.stl";
  options.further = {directory / "b.gltf"};
  options.parts.by = PartsBy::kFile;
  const RunLimits limits(RunOptions{}, options.path);
  MeshParts parts(options, limits, WholeMesh::kUnused);
  std::vector<Warning> warnings;
  EXPECT_EQ(parts.part(1, warnings).triangles.size(), 1U);
  write_text(directory / "b.bin", corners(2));
  EXPECT_THROW((void)parts.part(1, warnings), InputError);
}

}  // namespace
}  // namespace raycone::test
