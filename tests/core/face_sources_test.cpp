// Which face of the mesh each face of a surface is on.
#include "core/surface/face_sources.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/cells/unit_normal.h"
#include "core/distance/distance.h"
#include "core/machine/floating_point.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

// What is wrong is mended; what may be right, and holes, are left alone.
TEST(FaceSources, AreSettledWhereTheyCannotBe) {
  const DefaultFloatingPoint guard;
  const TriangleMesh input = test::box_mesh({0, 0, 0}, {1, 1, 1});
  SurfaceMesh surface{input, {}};
  std::vector<std::int32_t> own(input.triangles.size());
  std::iota(own.begin(), own.end(), 0);
  surface.sources.assign(own.size(), 5);
  surface.sources[7] = kHole;
  own[7] = kHole;
  const SurfaceMesh before = surface;
  SourceSettler(input, TriangleNormals(input), DistanceEvaluator(input), 10.0).settle(surface);
  EXPECT_NE(surface.sources, before.sources);
  EXPECT_NE(surface.sources, own);  // parallel planes are within 10 of each other
  SourceSettler(input, TriangleNormals(input), DistanceEvaluator(input), 0.1).settle(surface);
  for (std::size_t face = 0; face < own.size(); ++face) {
    if (own[face] == kHole) {
      EXPECT_EQ(surface.sources[face], kHole);
      continue;
    }
    const Triangle& t = input.triangles[static_cast<std::size_t>(surface.sources[face])];
    const Triangle& expected = input.triangles[face];
    const auto normal = [&](const Triangle& u) {
      return unit_normal(input.vertices[u[0]], input.vertices[u[1]], input.vertices[u[2]]);
    };
    EXPECT_EQ(dot(normal(t), normal(expected)), 1.0);
  }
}

// The top of a box that has none: one of its faces closes the hole, and so does the one beside it.
TEST(FaceSources, AreNoneBesideAndInLineWithAHole) {
  const DefaultFloatingPoint guard;
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  TriangleMesh input{box.vertices, {}};
  SurfaceMesh surface{box, {}};
  std::vector<std::size_t> top;
  for (std::size_t face = 0; face < box.triangles.size(); ++face) {
    const Triangle& t = box.triangles[face];
    if (std::ranges::all_of(t, [&](std::uint32_t v) { return box.vertices[v].z == 1.0; })) {
      top.push_back(face);
      surface.sources.push_back(0);
    } else {
      surface.sources.push_back(static_cast<std::int32_t>(input.triangles.size()));
      input.triangles.push_back(t);
    }
  }
  ASSERT_EQ(top.size(), 2U);
  const TriangleNormals normals(input);
  const DistanceEvaluator distance(input);
  const SourceSettler settler(input, normals, distance, 0.1);
  SurfaceMesh expected = surface, without_hole = surface;
  surface.sources[top[0]] = expected.sources[top[0]] = expected.sources[top[1]] = kHole;
  settler.settle(surface);
  EXPECT_EQ(surface.sources, expected.sources);
  settler.settle(without_hole);
  EXPECT_EQ(std::ranges::count(without_hole.sources, kHole), 0);
}

}  // namespace
}  // namespace raycone
