#include "core/filling/mesh_as_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/cells/node_set.h"
#include "core/cells/source_plane.h"
#include "core/certificate/certificate.h"
#include "core/data/coordinate_precision.h"
#include "core/data/rule.h"
#include "core/evaluation/winding_number.h"
#include "core/mesh/exterior_edges.h"
#include "tests/core/mesh_as_surface_cases.h"
#include "tests/core/surface_cases.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::box_at;
using test::finned;
using test::holds_all;
using test::kept;
using test::nodes_of;
using test::sorted_vertices;
using test::turned;
using test::volume_of;

// Of a mesh with faults, or that is not what the rule asks for, the border. Parts that touch are apart by 2^-30 of a
// voxel, a twentieth, or 32 roundings to float, 4e-6: some times that, for the areas of the parts.
void expect_volume(const TriangleMesh& mesh, double volume, const Rule& rule = {}) {
  for (const CoordinatePrecision precision : {CoordinatePrecision::kDouble, CoordinatePrecision::kSingle}) {
    const bool is_single = precision == CoordinatePrecision::kSingle;
    const double most = is_single ? 5e-5 : 1e-9;
    const std::optional<FinishedSurface> made = kept(turned(mesh), 20, {.rule = rule, .precision = precision});
    ASSERT_TRUE(made) << volume << ' ' << is_single;
    EXPECT_TRUE(made->merged);
    EXPECT_NEAR(volume_of(made->surface.mesh), volume, most);
    for (std::size_t face = 0; face < made->surface.sources.size(); ++face) {
      const SourcePlane plane = source_plane(turned(mesh), made->surface.sources[face]);
      for (const std::uint32_t v : made->surface.mesh.triangles[face])
        EXPECT_LT(std::abs(plane.height(made->surface.mesh.vertices[v])), most);
    }
  }
}

TEST(MeshAsSurface, IsTheBorderOfAClosedMeshWithFaults) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const TriangleMesh through = box_at(0.5, 0.7);  // 0.5 by 0.7 by 0.6 of which is in the box
  expect_volume(test::joined(box, through), 1.0 + 0.343 - 0.21);
  expect_volume(test::joined(box, through), 0.21, {RuleKind::kThreshold, 1.5});
  expect_volume(test::joined(box, test::reversed(through)), 1.0 - 0.21);
  expect_volume(test::reversed(box), 1.0, {RuleKind::kNonzero});
  expect_volume(test::joined(box, test::reversed(box_at(1.5, 0.4))), 1.064, {RuleKind::kNonzero});
  expect_volume(test::joined(box, box_at(0.2, 0.4)), 0.936, {RuleKind::kOdd});
  expect_volume(test::joined(box, box), 1.0);
  expect_volume(test::joined(box, test::box_mesh({1, 0, 0}, {2, 1, 1})), 2.0);          // they share a side
  expect_volume(test::joined(box, test::box_mesh({1, 0.2, 0.2}, {2, 0.7, 1.4})), 1.6);  // a part of one
  expect_volume(test::cells_mesh({{0, 0, 0}, {1, 1, 0}}), 2.0);                         // an edge
  expect_volume(test::cells_mesh({{0, 0, 0}, {1, 1, 1}}), 2.0);                         // a corner
  expect_volume(test::cells_mesh({{0, 0, 0}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}}), 4.0);   // all of these
  TriangleMesh split = box;  // with a face of no area at an edge
  const Triangle first = split.triangles[0];
  split.vertices.push_back(0.5 * (split.vertices[first[0]] + split.vertices[first[1]]));
  const auto middle = static_cast<std::uint32_t>(split.vertices.size() - 1);
  split.triangles[0] = {first[0], middle, first[2]};
  split.triangles.push_back({middle, first[1], first[2]});
  split.triangles.push_back({first[0], first[1], middle});
  EXPECT_EQ(exterior_edges(split).size(), 0U);
  expect_volume(split, 1.0);
}

// Boxes of which an odd number are around what is inside: they touch along edges next to samples on their sides, and at
// either end of an edge the same part must move.
TEST(MeshAsSurface, HasSamplesBesidePartsThatTouch) {
  const TriangleMesh boxes =
      test::joined(test::joined(test::box_mesh({4, 3, 1}, {5, 4, 3}), test::box_mesh({4, 1, 0}, {5, 3, 2})),
                   test::joined(test::box_mesh({4, 3, 3}, {5, 4, 4}), test::box_mesh({2, 1, 0}, {5, 2, 5})));
  const Rule odd{RuleKind::kOdd};
  const WindingNumberEvaluator evaluator(boxes);
  for (const double voxel : {0.25, 0.37, 0.5}) {
    const auto count = static_cast<std::int64_t>(6.5 / voxel);
    const Lattice lattice{{0, 0, 0}, {voxel, voxel, voxel}, {-2, -2, -2}, {count, count, count}};
    const NodeSet inside = nodes_inside(evaluator, odd, lattice);
    const std::optional<FinishedSurface> made = mesh_as_surface({boxes, evaluator, inside, {.rule = odd}});
    ASSERT_TRUE(made) << voxel;
    EXPECT_TRUE(faults_of(made->surface.mesh, inside).none());
    EXPECT_NEAR(volume_of(made->surface.mesh), 18.0, 1e-7);
  }
}

// A bubble so small that no sample is in it, but next to the side of the box, so that cells there are of both kinds.
TEST(MeshAsSurface, LooksIntoComponentsWithoutSamples) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  for (const bool outward : {false, true}) {
    for (const double x : {0.9996, 1.0001}) {
      const TriangleMesh bubble = box_at(x, 0.0003);
      const TriangleMesh mesh = turned(test::joined(box, outward ? bubble : test::reversed(bubble)));
      EXPECT_EQ(nodes_of(mesh, 20).size(), nodes_of(turned(box), 20).size());
      const std::optional<FinishedSurface> made = kept(mesh, 20);
      ASSERT_TRUE(made);
      const bool is_border = outward == (x > 1.0);
      EXPECT_EQ(made->surface.mesh.triangles.size(), is_border ? 24U : 12U) << outward << ' ' << x;
      EXPECT_EQ(holds_all(*made), is_border) << outward << ' ' << x;
    }
  }
}

// What is within another solid, or inside out beside it, is no border of what the rule asks for.
TEST(MeshAsSurface, IsWithoutComponentsThatSeparateNothing) {
  const TriangleMesh box = turned(test::box_mesh({0, 0, 0}, {1, 1, 1}));
  const TriangleMesh within = turned(box_at(0.2, 0.4)), beside = turned(test::reversed(box_at(1.5, 0.4)));
  const auto is_left = [](const TriangleMesh& mesh, const Rule& rule, const TriangleMesh& left) {
    const std::optional<FinishedSurface> made = kept(mesh, 20, {.rule = rule});
    ASSERT_TRUE(made);
    EXPECT_EQ(sorted_vertices(made->surface.mesh), sorted_vertices(left));
    EXPECT_FALSE(holds_all(*made));
    for (std::size_t face = 0; face < made->surface.sources.size(); ++face) {
      const SourcePlane plane = source_plane(mesh, made->surface.sources[face]);
      for (const std::uint32_t v : made->surface.mesh.triangles[face])
        EXPECT_LT(std::abs(plane.height(made->surface.mesh.vertices[v])), 1e-15);  // some roundings
    }
  };
  is_left(test::joined(within, box), {}, box);
  is_left(test::joined(within, box), {RuleKind::kThreshold, 1.5}, within);
  is_left(test::joined(test::joined(beside, within), box), {}, box);
}

TEST(MeshAsSurface, IsWithoutWhatTheLatticeDoesNotSee) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const double voxel = 1.0 / 16.0;
  // `samples`: along z. Those of a plate that is 0.6 voxels thick lie before and behind it, or within.
  const auto with_plate = [&](double samples, double gap) {
    return test::joined(box, test::box_mesh({0, 0, 1.0 + gap * voxel}, {1, 1, samples * voxel}));
  };
  EXPECT_TRUE(kept(with_plate(20.8, 4.2), 20.8));
  for (const auto& [samples, gap] : {std::array{21.2, 4.6}, {18.2, 1.6}}) {  // far, or near, in no cell with both
    const std::optional<FinishedSurface> made = kept(with_plate(samples, gap), samples);
    ASSERT_TRUE(made);
    EXPECT_EQ(sorted_vertices(made->surface.mesh), sorted_vertices(box));
    EXPECT_EQ(std::ranges::count(made->own->held, true), 12);
  }
  const auto fin = [&](double voxels) { return finned(0.3 * voxel, voxels * voxel); };
  EXPECT_TRUE(kept(fin(3.9), 16.0 + 3.9));
  EXPECT_FALSE(kept(fin(12.1), 16.0 + 12.1));
}

}  // namespace
}  // namespace raycone
