// Self-intersections of real meshes, against all pairs in rational numbers.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>

#include "core/intersections/self_intersections.h"
#include "core/mesh/weld.h"
#include "io/files/file_error.h"
#include "io/mesh/read_mesh.h"
#include "tests/support/exact_intersections.h"

namespace raycone {
namespace {

namespace fs = std::filesystem;

// Larger meshes take the oracle minutes: for a longer check, RAYCONE_ALL_PAIRS_UP_TO=3000.
std::size_t most_faces() {
  const char* const text = std::getenv("RAYCONE_ALL_PAIRS_UP_TO");
  return text ? std::stoul(text) : 60;
}

std::set<std::string> files_in(const std::string& directory) {
  std::set<std::string> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(directory, error)) {
    const std::string path = entry.path().string();
    if (entry.is_regular_file() && entry.file_size() < 1'000'000) files.insert(path);
  }
  return files;
}

TEST(SharedIntersections, AreThoseOfAllPairs) {
  const std::set<std::string> files = files_in(RAYCONE_SHARED_MESHES);
  if (files.empty()) GTEST_SKIP() << "no shared meshes in " << RAYCONE_SHARED_MESHES;
  int meshes = 0, intersecting = 0;
  for (const std::string& path : files) {
    TriangleMesh mesh;
    try {
      mesh = weld(read_mesh(path, {}).parsed.mesh, {});
    } catch (const InputError&) {
      continue;  // no mesh, or a broken one
    }
    if (mesh.triangles.size() > most_faces()) continue;
    ++meshes;
    const auto expected = test::exact_self_intersections(mesh);
    intersecting += !expected.empty();
    EXPECT_EQ(self_intersections(mesh).pairs, expected.size()) << path;
  }
  RecordProperty("meshes", meshes);
  EXPECT_GT(meshes, 10);
  EXPECT_GT(intersecting, 0);
}

}  // namespace
}  // namespace raycone
