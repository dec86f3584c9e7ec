// Vertices of a surface that take the place of corners of the mesh.
#include "core/merging/mesh_corners.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/cells/surface_mesh.h"

namespace raycone {
namespace {

TEST(MeshCorners, TakeTheNearestVertexEach) {
  const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {NAN, 0, 0}}, {{0, 1, 2}}};
  const Lattice lattice{{0, 0, 0}, {0.5, 0.5, 0.5}, {-1, -1, -1}, {5, 5, 5}};
  std::vector<Vec3> vertices{{0.002, 0, 0}, {-0.001, 0, 0}, {0, 0.001, 0}, {1, 0.004, 0}, {0.004, 0.996, -0.006}};
  move_to_corners(mesh, lattice, 0.005, vertices);
  const std::vector<Vec3> expected{{0.002, 0, 0}, {0, 0, 0}, {0, 0.001, 0}, {1, 0, 0}, {0.004, 0.996, -0.006}};
  EXPECT_EQ(vertices, expected);
}

TEST(MeshCorners, GiveAVertexToTheNearestOfThem) {
  const TriangleMesh mesh{{{0, 0, 0}, {0.003, 0, 0}, {0.001, 0.002, 0}, {0, 1, 0}}, {{0, 1, 3}, {1, 2, 3}}};
  const Lattice lattice{{0, 0, 0}, {0.5, 0.5, 0.5}, {-1, -1, -1}, {5, 5, 5}};
  std::vector<Vec3> vertices{{0.002, 0, 0}};
  move_to_corners(mesh, lattice, 0.005, vertices);
  EXPECT_EQ(vertices, (std::vector<Vec3>{{0.003, 0, 0}}));
}

TEST(MeshCorners, LevelPlanesTakeCornersOfTheirFacesAlone) {
  const TriangleMesh mesh{{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0, 0, 2}}, {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}}};
  TriangleMesh surface{
      {{0.1, 0.001, 1.001}, {0.5, 0.1, 0.999}, {0.1, 0.5, 1.01}, {0.1, -0.003, 1.5}, {0.9, 0.2, 1.002}},
      {{0, 1, 2}, {1, 0, 3}, {1, 4, 3}, {2, 4, 3}}};
  move_into_level_planes(mesh, {0, 1, 2, kHole}, 0.005, surface);
  const std::vector<Vec3> expected{{0.1, 0, 1}, {0.5, 0.1, 1}, {0.1, 0.5, 1.01}, {0.1, 0, 1.5}, {0.9, 0.2, 1.002}};
  EXPECT_EQ(surface.vertices, expected);
}

}  // namespace
}  // namespace raycone
