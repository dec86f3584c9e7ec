#include "core/filling/mesh_as_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "core/cells/node_set.h"
#include "core/cells/surface_mesh.h"
#include "core/certificate/certificate.h"
#include "core/data/coordinate_precision.h"
#include "core/evaluation/winding_number.h"
#include "core/mesh/components.h"
#include "core/mesh/exterior_edges.h"
#include "core/mesh/used_part.h"
#include "core/mesh/weld.h"
#include "tests/core/mesh_as_surface_cases.h"
#include "tests/core/surface_cases.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::bitten_sphere;
using test::box_at;
using test::holds_all;
using test::kept;
using test::turned;
using test::volume_of;

// Without faces in the middle of the box, at the end of a side, or of a sphere's top.
TriangleMesh without(TriangleMesh mesh, const Box& box) {
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    const auto [a, b, c] = corners_of(mesh, t);
    return contains(box, (1.0 / 3.0) * (a + b + c));
  });
  return mesh;
}

// Many caps are not many holes.
TEST(MeshAsSurface, TakesAFinelyDividedRimForOneHole) {
  constexpr std::uint32_t kSides = 1200;
  TriangleMesh cup;
  for (std::uint32_t n = 0; n < kSides; ++n) {
    const double angle = 2 * std::numbers::pi * n / kSides;
    cup.vertices.push_back({std::cos(angle), std::sin(angle), 0});
    cup.vertices.push_back({std::cos(angle), std::sin(angle), 1});
    const std::uint32_t low = 2 * n, next = 2 * ((n + 1) % kSides);
    cup.triangles.push_back({low, next, next + 1});
    cup.triangles.push_back({low, next + 1, low + 1});
    if (n > 0 && n + 1 < kSides) cup.triangles.push_back({0, next, low});
  }
  const std::optional<FinishedSurface> made = kept(cup, 20);
  ASSERT_TRUE(made);
  EXPECT_LT(made->surface.mesh.triangles.size(), 2 * cup.triangles.size());
}

TEST(MeshAsSurface, ClosesHolesAlongTheThreshold) {
  const TriangleMesh sphere = test::sphere(10);
  for (const TriangleMesh& mesh :
       {test::open_box(), test::joined(box_at(2, 0.5), test::open_box()), without(sphere, {{-2, -2, 0.8}, {2, 2, 2}}),
        without(sphere, {{0.2, 0.1, 0.3}, {2, 2, 0.8}})}) {
    for (const CoordinatePrecision precision : {CoordinatePrecision::kDouble, CoordinatePrecision::kSingle}) {
      const std::optional<FinishedSurface> made = kept(turned(mesh), 27, {.rule = Rule{}, .precision = precision});
      ASSERT_TRUE(made);
      EXPECT_TRUE(holds_all(*made));
      EXPECT_TRUE(made->merged);
      EXPECT_GT(std::ranges::count(made->surface.sources, kHole), 0);
      EXPECT_GE(made->surface.mesh.vertices.size(), used_part(mesh.vertices, mesh.triangles).vertices.size());
    }
  }
}

// The threshold is at the mesh's own faces where caps are in front of these.
TEST(MeshAsSurface, ClosesHolesWhoseCapsAreInFrontOfFaces) {
  for (const TriangleMesh& mesh : {bitten_sphere(6, 0.3, 0.46, 2, 5.5), bitten_sphere(13, -0.04, 0.1, 2, 4.4),
                                   bitten_sphere(12, 0.51, 0.27, 1, 1.7), bitten_sphere(7, 0.43, 0.22, 1, 3.6)}) {
    const std::optional<FinishedSurface> made = kept(test::moved(turned(mesh), {1.3, 1.4, 1.0}, {0, 0, 0}), 40);
    ASSERT_TRUE(made);
    EXPECT_GT(std::ranges::count(made->surface.sources, kHole), 0);
  }
}

// Samples in the plane of a hole have just the threshold, and count as inside.
TEST(MeshAsSurface, HasSamplesInTheHolesPlane) {
  const Lattice lattice{{-0.25, -0.25, -0.25}, {0.125, 0.125, 0.125}, {0, 0, 0}, {13, 13, 13}};
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      TriangleMesh box = test::open_box();  // without its top
      for (Vec3& v : box.vertices) {
        for (int n = 0; n < axis; ++n) v = {v.y, v.z, v.x};
        v = sign * v + (sign < 0.0 ? Vec3{1, 1, 1} : Vec3{});
      }
      if (sign < 0.0) box = test::reversed(box);
      const WindingNumberEvaluator evaluator(box);
      const NodeSet inside = nodes_inside(evaluator, Rule{}, lattice);
      const std::optional<FinishedSurface> made = mesh_as_surface({box, evaluator, inside, {}});
      ASSERT_TRUE(made) << axis << ' ' << sign;
      EXPECT_TRUE(faults_of(made->surface.mesh, inside).none());
      EXPECT_LE(made->surface.mesh.triangles.size(), 20U);
      EXPECT_NEAR(volume_of(made->surface.mesh), 1.0, 1e-9);
    }
  }
}

// Of a cracked box, one side of which does not meet the others, and of two that have lost the faces between them.
TEST(MeshAsSurface, ClosesCracks) {
  TriangleMesh cracked = test::open_box();
  const auto first = static_cast<std::uint32_t>(cracked.vertices.size());
  cracked.vertices.insert(cracked.vertices.end(), {{0, 0, 1.001}, {1, 0, 1}, {1, 1, 1.001}, {0, 1, 1.002}});
  cracked.triangles.insert(cracked.triangles.end(), {{first, first + 1, first + 2}, {first, first + 2, first + 3}});
  EXPECT_FALSE(exterior_edges(weld(cracked, {})).empty());
  const std::optional<FinishedSurface> box = kept(turned(weld(cracked, {})), 30);
  ASSERT_TRUE(box);
  // The lids' mean heights are 1 + 0.002 / 3 and 1 + 0.004 / 3; what closes the cracks lies in the planes of the sides.
  EXPECT_NEAR(volume_of(box->surface.mesh), 1.001, 1e-13);  // roundings of the turn
  // The edge along one side is cut in two, so that triangles do not share it: a crack without width.
  TriangleMesh split = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const Triangle one = split.triangles[0];
  split.vertices.push_back(0.5 * (split.vertices[one[0]] + split.vertices[one[1]]));
  const auto middle = static_cast<std::uint32_t>(split.vertices.size() - 1);
  split.triangles[0] = {one[0], middle, one[2]};
  split.triangles.push_back({middle, one[1], one[2]});
  EXPECT_FALSE(exterior_edges(split).empty());
  const std::optional<FinishedSurface> whole = kept(split, 30);
  ASSERT_TRUE(whole);
  EXPECT_EQ(std::ranges::count(whole->surface.sources, kHole), 0);
  EXPECT_DOUBLE_EQ(volume_of(whole->surface.mesh), 1.0);
}

// The bottom's corners are off those of the sides by some roundings, or by more.
TEST(MeshAsSurface, ClosesCracksOfRoundingsWithoutFaces) {
  for (const double off : {1e-15, 1e-6}) {
    TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
    const auto first = static_cast<std::uint32_t>(box.vertices.size());
    for (const Vec3& corner : std::vector<Vec3>{{0, 0, off}, {1, 0, -off}, {1, 1, off}, {0, 1, -off}}) {
      box.vertices.push_back(corner);
    }
    std::erase_if(box.triangles, [&](const Triangle& t) {
      return std::ranges::all_of(t, [&](std::uint32_t corner) { return box.vertices[corner].z == 0.0; });
    });
    ASSERT_EQ(box.triangles.size(), 10U);
    box.triangles.push_back({first, first + 2, first + 1});
    box.triangles.push_back({first, first + 3, first + 2});
    ASSERT_EQ(exterior_edges(box).size(), 8U);
    const std::optional<FinishedSurface> made = kept(box, 20.8);
    ASSERT_TRUE(made) << off;
    EXPECT_EQ(std::ranges::count(made->surface.sources, kHole) == 0, off < 1e-9);
    EXPECT_EQ(made->surface.sources.size() == 12, off < 1e-9);
    EXPECT_NEAR(volume_of(made->surface.mesh), 1.0, off);
  }
}

// Where the threshold is not along what could close a hole: in a ring around the inside of a short pipe, and where a
// sheet has nothing inside but what it is near to.
TEST(MeshAsSurface, IsNoneOfMeshesThatAreMostlyHole) {
  const TriangleMesh pipe =
      without(without(test::sphere(10), {{-2, -2, 0.4}, {2, 2, 2}}), {{-2, -2, -2}, {2, 2, -0.4}});
  EXPECT_FALSE(kept(turned(pipe), 20));
}

// Above a box without top w is a bit more than 0, so behind a sheet there it is above 1/2. A sample is there, which the
// sheet's caps leave outside.
TEST(MeshAsSurface, HasIslandsAroundNodesBehindSheets) {
  TriangleMesh mesh = test::open_box();
  test::add_triangle(mesh, {0.4, 0.4, 2.105}, {0.8, 0.4, 2.105}, {0.6, 0.8, 2.105});
  const Lattice lattice{{-0.4, -0.4, -0.4}, {0.25, 0.25, 0.25}, {0, 0, 0}, {10, 10, 13}};
  const WindingNumberEvaluator evaluator(mesh);
  const NodeSet inside = nodes_inside(evaluator, {}, lattice);
  ASSERT_TRUE(inside.holds(4, 4, 10));
  const std::optional<FinishedSurface> made = mesh_as_surface({mesh, evaluator, inside, {}});
  ASSERT_TRUE(made);
  EXPECT_TRUE(faults_of(made->surface.mesh, inside).none());
  EXPECT_EQ(components_of(made->surface.mesh).count, 2U);
  EXPECT_EQ(std::ranges::count(made->own->held, true), 10);
  EXPECT_GT(made->own->left_out_of_all, 0.0);  // the rest of what is behind the sheet
}

// Beyond 2^64 the mesh is scaled. Of so many holes, evaluators differ by what they are made for.
TEST(MeshAsSurface, IsTheSameInEveryUnitWithTwoEvaluators) {
  test::Random random(8);
  const TriangleMesh sieve = test::with_holes(test::sphere(40), random, 0.1);
  const auto made = [&](double unit) {
    const TriangleMesh mesh = test::moved(sieve, {unit, unit, unit}, {0, 0, 0});
    const double h = 0.1 * unit, first = -1.25 * unit;
    const Lattice lattice{{first, first, first}, {h, h, h}, {0, 0, 0}, {26, 26, 26}};
    constexpr double kPoints = 1e6;
    const WindingNumberEvaluator fine(mesh, {.accuracy = {.tolerance = 1e-6, .samples = kPoints, .points = kPoints}});
    const WindingNumberEvaluator rough(mesh, {.accuracy = {.tolerance = 1e-5, .samples = kPoints, .points = kPoints}});
    std::optional<FinishedSurface> surface =
        mesh_as_surface({mesh, FineAndRough(fine, rough), nodes_inside(rough, {}, lattice), {}});
    return surface ? test::moved(surface->surface.mesh, {1 / unit, 1 / unit, 1 / unit}, {0, 0, 0}) : TriangleMesh();
  };
  const TriangleMesh expected = made(1.0);
  ASSERT_FALSE(expected.triangles.empty());
  for (const double unit : {0x1p100, 0x1p-100}) EXPECT_EQ(made(unit).vertices, expected.vertices);
}

}  // namespace
}  // namespace raycone
