// The faces of a brick that become fewer.
#include "core/merging/patch_merger.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "core/machine/floating_point.h"

namespace raycone {
namespace {

// A patch with a face on each side of a sheet without thickness: a fin. All its faces are in one plane but for their
// fronts, and it has no other planes to hold its rim.
SurfacePatch fin() {
  // A square with a tip: the front, then the back, with a vertex in the middle of each side's border.
  SurfacePatch patch;
  patch.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 1, 0}};
  for (std::uint32_t v = 1; v + 1 < 6; ++v) {
    patch.triangles.push_back({0, v, v + 1});
    patch.triangles.push_back({0, v + 1, v});
  }
  patch.roles.assign(patch.vertices.size(), VertexRole::kFree);
  patch.settled.assign(patch.vertices.size(), 0);
  patch.sources.assign(patch.triangles.size(), 0);
  return patch;
}

// Found by an attack: the tip of a fin was pulled in, which leaves each face in its plane.
TEST(PatchMerger, KeepsTheRimOfAFin) {
  const DefaultFloatingPoint guard;
  const TriangleMesh input{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const SurfacePatch patch = fin();
  PatchMerger merged(patch, input, {1e-9, 1e-8});
  merged.merge();
  for (const std::uint32_t corner : {0U, 2U, 3U, 4U, 5U}) EXPECT_EQ(merged.into()[corner], corner);
}

// The ridge of a blade of five degrees: what is a bit behind it is near to both planes.
TEST(PatchMerger, KeepsTheRidgeOfABlade) {
  const DefaultFloatingPoint guard;
  constexpr double kBehind = 1.5e-8, kHalf = 0.0437;  // the tangent of half the angle
  const Vec3 lower{1, -1, -kHalf}, upper{1, -1, kHalf};
  SurfacePatch patch;
  patch.vertices = {{0, -kBehind, 0}, {1, 0, 0}, {2, -kBehind, 0}, lower, upper};
  patch.triangles = {{0, 1, 3}, {1, 2, 3}, {1, 0, 4}, {2, 1, 4}, {0, 3, 4}, {3, 2, 4}};
  patch.sources = {0, 0, 1, 1, 2, 3};
  patch.roles.assign(patch.vertices.size(), VertexRole::kFree);
  patch.settled.assign(patch.vertices.size(), 0);
  // The planes meet in the line of the middle vertex.
  const TriangleMesh input{{{0, 0, 0}, {2, 0, 0}, lower, upper, patch.vertices[0], patch.vertices[2]},
                           {{0, 1, 2}, {1, 0, 3}, {4, 2, 3}, {2, 5, 3}}};
  PatchMerger merged(patch, input, {1e-9, 1e-8});
  merged.merge();
  EXPECT_EQ(merged.into()[1], 1U);
  patch.vertices[0].y = patch.vertices[2].y = 0.0;  // on one straight line
  PatchMerger straight(patch, input, {1e-9, 1e-8});
  straight.merge();
  EXPECT_NE(straight.into()[1], 1U);
}

// Whether a vertex among `ring`, all of whose faces are in a patch, is settled there. Each face is its own source. Only
// the vertex itself has all of its faces in it.
bool is_settled_among(const std::vector<Vec3>& ring) {
  SurfacePatch patch{{{0, 0, 0}}, {VertexRole::kFree}, {0}, {}, {}};
  for (std::uint32_t i = 0; i < ring.size(); ++i) {
    patch.vertices.push_back(ring[i]);
    patch.roles.push_back(VertexRole::kForeign);
    patch.settled.push_back(0);
    patch.triangles.push_back({0, 1 + i, 1 + (i + 1) % static_cast<std::uint32_t>(ring.size())});
    patch.sources.push_back(static_cast<std::int32_t>(i));
  }
  const TriangleMesh input{patch.vertices, patch.triangles};
  PatchMerger merger(patch, input, {1e-9, 0.0});
  merger.merge();
  EXPECT_EQ(merger.into()[0], 0U);
  return merger.is_settled(0);
}

// Another brick may pull a vertex along a ridge, or within a plane, whose neighbours are foreign here. None can pull
// one at a corner.
TEST(PatchMerger, SettlesWhatStaysInAnyBrick) {
  EXPECT_FALSE(is_settled_among({{1, 0, 0}, {0, 1, -1}, {-1, 0, 0}, {0, -1, -1}}));
  EXPECT_FALSE(is_settled_among({{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}));
  EXPECT_TRUE(is_settled_among({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_TRUE(is_settled_among({{1, 0, -1}, {0, 1, -1}, {-1, 0, -1}, {0, -1, -1}}));
}

}  // namespace
}  // namespace raycone
