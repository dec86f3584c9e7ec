#include "core/filling/fit_to_threshold.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/cells/surface_mesh.h"
#include "core/certificate/certificate.h"
#include "core/data/coordinate_precision.h"
#include "core/evaluation/winding_number.h"
#include "core/exact/direct_sum.h"
#include "core/filling/closed_by_caps.h"
#include "core/filling/fill_check.h"
#include "core/machine/floating_point.h"
#include "core/mesh/exterior_edges.h"
#include "tests/core/surface_cases.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::bitten_sphere;
using test::part_of_sphere;

// With a round hole whose border bends.
TriangleMesh bent_bowl() {
  TriangleMesh mesh = part_of_sphere(12, [](const Vec3& p) { return p.z < 0.6; });
  for (Vec3& v : mesh.vertices) v.z += 0.3 * (v.x * v.x - v.y * v.y);
  return mesh;
}

// With one whose border is jagged: the mesh has teeth there that have nothing inside.
TriangleMesh jagged_sphere() { return bitten_sphere(16, 0.45, 0.2, 2.0); }

Lattice lattice_of(double voxel) {
  const auto count = static_cast<std::int64_t>(std::ceil(2.6 / voxel));
  return {{-1.303, -1.301, -1.302}, {voxel, voxel, voxel}, {0, 0, 0}, {count, count, count}};
}

struct Filled {
  SurfaceMesh surface;
  NodeSet inside;
  bool fits = false;
};

Filled filled(const TriangleMesh& mesh, double voxel, const FitOptions& options, const Rule& rule = {}) {
  const DefaultFloatingPoint guard;
  const WindingNumberEvaluator evaluator(mesh);
  SurfaceMesh surface{closed_by_caps(mesh, exterior_edges(mesh)), {}};
  surface.sources.resize(surface.mesh.triangles.size(), kHole);
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) surface.sources[n] = static_cast<std::int32_t>(n);
  NodeSet inside = nodes_inside(evaluator, rule, lattice_of(voxel));
  const bool fits = fit_to_threshold(surface, RuleAlong(evaluator, rule), inside, options);
  return {std::move(surface), std::move(inside), fits};
}

// New vertices are where a direct sum over all triangles in 113 bits is the threshold.
TEST(FitToThreshold, FollowsTheThreshold) {
  for (const double threshold : {0.5, 0.4}) {
    const TriangleMesh mesh = bent_bowl();
    const Rule rule{RuleKind::kThreshold, threshold};
    const Filled result = filled(mesh, 0.1, {.most_faces = 10000}, rule);
    ASSERT_TRUE(result.fits);
    const TriangleMesh& surface = result.surface.mesh;
    const SurfaceFaults faults = faults_of(surface, result.inside);
    EXPECT_EQ(faults.edges + faults.links + faults.nodes, 0U);
    ASSERT_GT(surface.vertices.size(), mesh.vertices.size() + 50);
    for (std::size_t n = mesh.vertices.size(); n < surface.vertices.size(); ++n) {
      const double w = static_cast<double>(perturbed_direct_sum(mesh, surface.vertices[n]).value);
      EXPECT_NEAR(w, threshold, 1e-9);  // 2^-34 of a search of some 0.1, where w changes by 1 to 10 a unit
    }
    const DefaultFloatingPoint guard;
    const WindingNumberEvaluator evaluator(mesh);
    EXPECT_TRUE(is_along_threshold(result.surface, RuleAlong(evaluator, rule), 0.1));
    EXPECT_FALSE(is_along_threshold(result.surface, RuleAlong(evaluator, rule), 1e-4));
  }
}

// Of caps alone they are not, nor are nodes on their sides: the test above can fail.
TEST(FitToThreshold, NeedsFacesEnough) {
  const TriangleMesh mesh = bent_bowl();
  EXPECT_FALSE(filled(mesh, 0.1, {.most_faces = 40}).fits);
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(mesh), Rule{}, lattice_of(0.1));
  EXPECT_GT(misplaced_nodes(closed_by_caps(mesh, exterior_edges(mesh)), inside).size(), 10U);
}

// Where the winding number is 1 or more at nodes inside, as it is 0 or less at the others.
TEST(FitToThreshold, PutsNodesOnTheirSides) {
  for (const double voxel : {0.1, 0.06}) {
    const Filled result = filled(jagged_sphere(), voxel, {.most_faces = 40000});
    EXPECT_TRUE(result.fits);
    NodeSet nodes = nodes_inside(WindingNumberEvaluator(result.surface.mesh), Rule{}, lattice_of(voxel));
    nodes.flip(result.inside);
    EXPECT_EQ(nodes.size(), 0U);
  }
}

TEST(FitToThreshold, LeavesWhatIsFlat) {
  const Filled result = filled(test::open_box(), 0.1, {.most_faces = 10000});
  EXPECT_TRUE(result.fits);
  EXPECT_EQ(result.surface.sources.size(), 12U);
}

TEST(FitToThreshold, RoundsNewVerticesToSinglePrecision) {
  TriangleMesh mesh = bent_bowl();
  round_to(CoordinatePrecision::kSingle, mesh.vertices);
  const Filled result = filled(mesh, 0.1, {.most_faces = 10000, .precision = CoordinatePrecision::kSingle});
  EXPECT_TRUE(result.fits);
  std::vector<Vec3> rounded = result.surface.mesh.vertices;
  round_to(CoordinatePrecision::kSingle, rounded);
  EXPECT_EQ(rounded, result.surface.mesh.vertices);
}

// Across the ends of a short pipe w is less than 1/2: what is inside is a ring.
TEST(FitToThreshold, IsNotAlongTheThresholdWhereThatIsElsewhere) {
  const TriangleMesh pipe = part_of_sphere(12, [](const Vec3& p) { return std::abs(p.z) < 0.4; });
  const Filled result = filled(pipe, 0.1, {.most_faces = 10000});
  const DefaultFloatingPoint guard;
  const WindingNumberEvaluator evaluator(pipe);
  EXPECT_FALSE(is_along_threshold(result.surface, RuleAlong(evaluator, Rule{}), 0.1));
}

}  // namespace
}  // namespace raycone
