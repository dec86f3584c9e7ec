#include "core/mesh/mesh_flaws.h"

#include <gtest/gtest.h>

#include "tests/support/shapes.h"

namespace raycone {
namespace {

TEST(MeshFlaws, OfASolidAreNone) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  EXPECT_TRUE(flawed_edges(box).empty());
  EXPECT_EQ(first_duplicate(box), std::nullopt);
}

TEST(MeshFlaws, AreExteriorInconsistentAndNonManifoldEdges) {
  // Edge 0-1 of two faces in one direction, edge 1-2 of three faces.
  TriangleMesh mesh;
  mesh.vertices.resize(6);
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {2, 1, 4}, {1, 2, 5}};
  std::size_t exterior = 0;
  for (const EdgeUse& edge : flawed_edges(mesh)) {
    exterior += edge.is_exterior();
    EXPECT_EQ(edge.is_inconsistent(), edge.low == 0 && edge.high == 1);
    EXPECT_EQ(edge.is_nonmanifold(), edge.low == 1 && edge.high == 2);
  }
  EXPECT_EQ(exterior, 9U);
  EXPECT_EQ(triangles_at(mesh, {.low = 1, .high = 2}), (std::vector<std::uint32_t>{0, 2, 3}));
}

TEST(MeshFlaws, ANonManifoldEdgeWhoseFacesCancelIsOne) {
  EXPECT_EQ(flawed_edges(test::fan(4, 2)).size(), 1 + 8U);  // and two outer edges a face
}

TEST(MeshFlaws, ADuplicateIsTheFirstOfEitherOrientation) {
  TriangleMesh mesh;
  mesh.vertices.resize(6);
  mesh.triangles = {{3, 4, 5}, {0, 1, 2}, {4, 3, 5}, {2, 1, 0}, {1, 2, 0}};
  EXPECT_EQ(first_duplicate(mesh), (std::array<std::uint32_t, 2>{0, 2}));
  mesh.triangles.erase(mesh.triangles.begin() + 2);
  EXPECT_EQ(first_duplicate(mesh), (std::array<std::uint32_t, 2>{1, 2}));
}

}  // namespace
}  // namespace raycone
