// Faces of one plane that become one.
#include "core/merging/merge_planes.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "core/certificate/certificate.h"
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

// Bricks that meet share vertices, and so would share edges that each of them makes by itself. With limits that are
// wide vertices of curved parts are pulled, too: faces may cross one another then, but every edge is still one of two
// faces.
TEST(MergedFaces, CloseUpWhereBricksMeet) {
  for (const TriangleMesh& mesh : {rotated(test::box_mesh({0, 0, 0}, {1, 1.5, 0.7})), rotated(cylinder())}) {
    const auto [fine, lattice] = surface_of(mesh, 80, {.rule = {}, .merge_planes = false});
    const NodeSet nodes = nodes_inside(WindingNumberEvaluator(mesh), Rule{}, lattice);
    const std::vector<bool> kept(fine.mesh.vertices.size(), false);
    for (const double most : {1e-9, 0.01, 0.3}) {
      const MergedFaces merged = PlaneMerger(fine, mesh, lattice, {most * lattice.spacing.x, 0.0}).merge(kept);
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
      const MergedFaces again = merger.merge(kept), once = PlaneMerger(fine, mesh, lattice, limits).merge(kept);
      EXPECT_EQ(again.triangles, once.triangles) << round;
      EXPECT_EQ(again.sources, once.sources) << round;
      EXPECT_EQ(again.into, once.into) << round;
      for (int n = 0; n < 1 << round % 6; ++n)
        kept[static_cast<std::size_t>(uniform(random, 0.0, static_cast<double>(kept.size())))].flip();
    }
  }
}

}  // namespace
}  // namespace raycone
