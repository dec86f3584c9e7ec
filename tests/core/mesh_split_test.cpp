#include "core/mesh/mesh_split.h"

#include <gtest/gtest.h>

namespace raycone {
namespace {

using Faces = std::vector<Triangle>;

TEST(MeshSplit, GivesEachPartItsFacesAndTheVerticesThatTheyUse) {
  const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}}, {{3, 1, 2}, {0, 1, 2}, {2, 1, 3}}};
  MeshSplit split(mesh, std::vector<std::uint32_t>{1, 0, 1}, 3);
  EXPECT_EQ(split.parts(), 3U);
  // Twice, and in any order: nothing is left behind by the part before.
  for (const std::uint32_t part : {1U, 0U, 1U}) {
    const TriangleMesh got = split.part(part);
    EXPECT_EQ(split.faces(part), got.triangles.size());
    if (part == 0) {
      EXPECT_EQ(got.vertices, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}));
      EXPECT_EQ(got.triangles, (Faces{{0, 1, 2}}));
    } else {
      EXPECT_EQ(got.vertices, (std::vector<Vec3>{{3, 0, 0}, {1, 0, 0}, {2, 0, 0}}));
      EXPECT_EQ(got.triangles, (Faces{{0, 1, 2}, {2, 1, 0}}));
    }
  }
  EXPECT_TRUE(split.part(2).triangles.empty());
}

}  // namespace
}  // namespace raycone
