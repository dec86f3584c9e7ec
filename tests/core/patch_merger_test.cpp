// Faces of one plane that become one.
#include "core/merging/patch_merger.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "core/cells/surface_cells.h"
#include "core/machine/floating_point.h"
#include "core/merging/merge_planes.h"
#include "tests/core/surface_cases.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::compacted;
using test::cylinder;
using test::Random;
using test::rotated;
using test::surface_of;
using test::uniform;

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

// Bricks that meet share vertices, and so would share edges that each of them makes by itself. With limits that are
// wide vertices of curved parts are pulled, too: faces may cross one another then, but every edge is still one of two
// faces.
TEST(MergedFaces, CloseUpWhereBricksMeet) {
  for (const TriangleMesh& mesh : {rotated(test::box_mesh({0, 0, 0}, {1, 1.5, 0.7})), rotated(cylinder())}) {
    const auto [fine, lattice] = surface_of(mesh, 80, {.rule = {}, .merge_planes = false});
    const NodeSet nodes = nodes_inside(WindingNumberEvaluator(mesh), Rule{}, lattice);
    const std::vector<bool> kept(fine.mesh.vertices.size(), false);
    for (const double most : {1e-9, 0.01, 0.3}) {
      const MergedFaces merged = merge_planes(fine, mesh, lattice, kept, {most * lattice.spacing.x, 0.0});
      EXPECT_LT(4 * merged.triangles.size(), fine.mesh.triangles.size());
      const SurfaceFaults faults = faults_of(compacted(fine.mesh.vertices, merged.triangles), nodes);
      EXPECT_EQ(faults.edges, 0U) << most;
      EXPECT_EQ(faults.links, 0U) << most;
    }
  }
}

// However often faces were merged before, and whatever was kept then.
TEST(MergedFaces, AreTheSameWhateverWasKeptBefore) {
  Random random(6);
  for (const TriangleMesh& mesh : {rotated(test::box_mesh({0, 0, 0}, {1, 1.5, 0.7})), rotated(cylinder())}) {
    const auto [fine, lattice] = surface_of(mesh, 80, {.rule = {}, .merge_planes = false});
    const MergeLimits limits{1e-9 * lattice.spacing.x, 0.0};
    std::vector<bool> kept(fine.mesh.vertices.size(), false);
    PlaneMerger merger(fine, mesh, lattice, limits);
    for (int round = 0; round < 12; ++round) {
      const MergedFaces again = merger.merge(kept), once = merge_planes(fine, mesh, lattice, kept, limits);
      EXPECT_EQ(again.triangles, once.triangles) << round;
      EXPECT_EQ(again.sources, once.sources) << round;
      EXPECT_EQ(again.into, once.into) << round;
      for (int n = 0; n < 1 << round % 6; ++n)
        kept[static_cast<std::size_t>(uniform(random, 0.0, static_cast<double>(kept.size())))].flip();
    }
  }
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
