// Faults of a surface that is merged again and again.
#include "core/merging/repeated_check.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/certificate/certificate.h"
#include "core/machine/floating_point.h"
#include "core/merging/merge_planes.h"
#include "core/mesh/used_part.h"
#include "tests/core/surface_cases.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::Random;
using test::rotated;
using test::surface_of;
using test::uniform;

// Each time some vertices are kept others than before, and some are moved, which makes faults, that stay or go.
TEST(RepeatedCheck, FindsWhatFaultsOfFinds) {
  const DefaultFloatingPoint guard;
  Random random(7);
  const TriangleMesh mesh = rotated(test::box_mesh({0, 0, 0}, {1, 1.5, 0.7}));
  const auto [fine, lattice] = surface_of(mesh, 40, {.rule = {}, .merge_planes = false});
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(mesh), Rule{}, lattice);
  std::vector<bool> kept(fine.mesh.vertices.size(), false);
  std::vector<Vec3> vertices = fine.mesh.vertices;
  const auto any_vertex = [&] {
    return static_cast<std::size_t>(uniform(random, 0.0, static_cast<double>(kept.size())));
  };
  for (std::size_t v = 0; v < kept.size(); ++v) kept[v] = uniform(random, 0.0, 1.0) < 0.5;
  PlaneMerger merger(fine, mesh, lattice, {1e-9 * lattice.spacing.x, 0.0});
  RepeatedCheck check(inside, kept.size());
  int right = 0, wrong = 0, still_wrong = 0;
  std::uint64_t last = 0;
  for (int round = 0; round < 60; ++round) {
    const MergedFaces merged = merger.merge(kept);
    const TriangleMesh now = used_part(vertices, merged.triangles);
    NodeSet misplaced(lattice), expected_nodes(lattice);
    const SurfaceFaults found = check.faults(merged, now, misplaced);
    const SurfaceFaults expected = faults_of(now, inside, &expected_nodes);
    ASSERT_EQ(described(found), described(expected)) << round;
    EXPECT_EQ(found.intersections.of_triangle, expected.intersections.of_triangle) << round;
    EXPECT_EQ(found.intersections.first.has_value(), expected.intersections.first.has_value());
    misplaced.flip(expected_nodes);
    EXPECT_TRUE(misplaced.empty());
    check.remember(merged, now, found);
    ++(found.none() ? right : wrong);
    still_wrong += last > 0 && found.intersections.pairs > 0 ? 1 : 0;
    last = found.intersections.pairs;
    for (int n = 0; n < 3; ++n) kept[any_vertex()].flip();
    if (round % 5 == 0) vertices = fine.mesh.vertices;
    if (round % 5 != 1 && round % 5 != 2) continue;
    const auto face = static_cast<std::size_t>(uniform(random, 0.0, static_cast<double>(merged.faces.size())));
    const std::uint32_t moved = merged.triangles[face][0];
    vertices[moved].x += uniform(random, -9.0, 9.0) * lattice.spacing.x;
    kept[moved] = true;
  }
  EXPECT_GT(right, 10);
  EXPECT_GT(wrong, 10);
  EXPECT_GT(still_wrong, 5);
}

// Of a surface that is known to have no faults before: few vertices are merged, and one is moved.
TEST(RepeatedCheck, FindsWhatFaultsOfFindsAfterAWholeSurface) {
  const DefaultFloatingPoint guard;
  Random random(8);
  const TriangleMesh mesh = rotated(test::box_mesh({0, 0, 0}, {1, 1.5, 0.7}));
  const auto [fine, lattice] = surface_of(mesh, 24, {.rule = {}, .merge_planes = false});
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(mesh), Rule{}, lattice);
  int right = 0, wrong = 0;
  for (int round = 0; round < 40; ++round) {
    std::vector<bool> kept(fine.mesh.vertices.size(), true);
    std::vector<Vec3> vertices = fine.mesh.vertices;
    for (int n = 0; n < 20; ++n)
      kept[static_cast<std::size_t>(uniform(random, 0.0, static_cast<double>(kept.size())))] = false;
    const MergedFaces merged = PlaneMerger(fine, mesh, lattice, {1e-9 * lattice.spacing.x, 0.0}).merge(kept);
    const auto face = static_cast<std::size_t>(uniform(random, 0.0, static_cast<double>(merged.faces.size())));
    if (round % 2 == 1) vertices[merged.triangles[face][0]].x += uniform(random, -9.0, 9.0) * lattice.spacing.x;
    const TriangleMesh now = used_part(vertices, merged.triangles);
    RepeatedCheck check(inside, kept.size());
    check.remember_whole(fine);
    NodeSet misplaced(lattice);
    const SurfaceFaults found = check.faults(merged, now, misplaced);
    EXPECT_EQ(described(found), described(faults_of(now, inside))) << round;
    ++(found.none() ? right : wrong);
  }
  EXPECT_GT(right, 10);
  EXPECT_GT(wrong, 5);
}

}  // namespace
}  // namespace raycone
