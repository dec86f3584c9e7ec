#include "core/filling/mesh_as_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "core/cells/node_set.h"
#include "core/cells/source_plane.h"
#include "core/cells/surface_cells.h"
#include "core/certificate/certificate.h"
#include "core/data/coordinate_precision.h"
#include "core/distance/distance.h"
#include "core/evaluation/winding_number.h"
#include "tests/core/mesh_as_surface_cases.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::box_at;
using test::finned;
using test::holds_all;
using test::kept;
using test::nodes_of;
using test::prism;
using test::sorted_vertices;
using test::turned;

// A box whose top is bent by a parabola in strips, two triangles each, with coordinates that are floats.
TriangleMesh bent_box(std::uint32_t strips, double depth, double bend, double height) {
  constexpr double kWidth = 1000;
  TriangleMesh mesh;
  for (const bool is_top : {true, false}) {
    for (std::uint32_t n = 0; n <= strips; ++n) {
      const double x = kWidth * (2.0 * n / strips - 1),
                   z = is_top ? height - bend * x * x / (kWidth * kWidth) : -height;
      mesh.vertices.insert(mesh.vertices.end(), {{x, -depth, z}, {x, depth, z}});
    }
  }
  round_to(CoordinatePrecision::kSingle, mesh.vertices);
  const std::uint32_t below = 2 * (strips + 1);
  const auto quad = [&mesh](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
  };
  for (std::uint32_t t = 0; t < 2 * strips; t += 2) {
    const std::uint32_t b = below + t;
    quad(t, t + 2, t + 3, t + 1);
    quad(b, b + 1, b + 3, b + 2);
    quad(b, b + 2, t + 2, t);
    quad(b + 3, b + 1, t + 1, t + 3);
  }
  quad(below + 1, below, 0, 1);
  quad(2 * below - 2, 2 * below - 1, below - 1, below - 2);
  return mesh;
}

TriangleMesh blade(double degrees) {
  const double half = std::tan(degrees / 360.0 * std::numbers::pi);
  return prism({{0.0, 0.0}, {1.0, -half}, {1.0, half}}, 1.0);
}

// Strip by strip, each in the planes of those that are left: the whole bend of 62 tolerances was merged away.
TEST(MeshAsSurface, MergingDoesNotAddUp) {
  for (const double simplify : {0.0, 9.6e-4}) {
    const TriangleMesh mesh = bent_box(3000, 1000, 0.0163, 1000);
    SurfaceOptions options;
    options.simplify = simplify;
    const std::optional<FinishedSurface> made = kept(mesh, 33, options);
    ASSERT_TRUE(made);
    EXPECT_LT(made->surface.mesh.triangles.size(), mesh.triangles.size() / 2) << "nothing was merged";
    std::vector<double> distances(mesh.vertices.size());
    DistanceEvaluator(made->surface.mesh).evaluate(mesh.vertices, distances);
    constexpr double kTolerance = 1000 * 0x1p-22;  // plane_tolerance() of floats
    EXPECT_LE(std::ranges::max(distances), simplify > 0.0 ? simplify : 2 * kTolerance);
  }
}

TEST(MeshAsSurface, IsTheMeshWhereThatIsASolid) {
  const TriangleMesh cavity = test::joined(test::box_mesh({0, 0, 0}, {1, 1, 1}), test::reversed(box_at(0.2, 0.4)));
  for (const TriangleMesh& mesh : {test::box_mesh({0, 0, 0}, {1, 2, 3}), test::sphere(6), blade(60), blade(5), cavity,
                                   test::joined(box_at(0, 0.5), box_at(0.6, 0.3))}) {
    for (const double side : {13.0, 40.7}) {
      const std::optional<FinishedSurface> made = kept(turned(mesh), side);
      ASSERT_TRUE(made);
      EXPECT_TRUE(holds_all(*made));
      EXPECT_TRUE(made->merged);
      EXPECT_EQ(sorted_vertices(made->surface.mesh), sorted_vertices(turned(mesh)));
    }
  }
}

// Samples are on faces then, and edges, and corners: of a box, and of an octahedron, whose faces are oblique.
TEST(MeshAsSurface, HasSamplesOnItsFacesOnTheirSides) {
  const Lattice lattice{{0, 0, 0}, {1, 1, 1}, {-6, -6, -6}, {13, 13, 13}};
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {4, 4, 4});
  TriangleMesh octahedron{{{4, 0, 0}, {-4, 0, 0}, {0, 4, 0}, {0, -4, 0}, {0, 0, 4}, {0, 0, -4}}, {}};
  for (const std::uint32_t x : {0U, 1U}) {
    for (const std::uint32_t y : {2U, 3U}) {
      for (const std::uint32_t z : {4U, 5U})
        octahedron.triangles.push_back((x + y + z) % 2 == 0 ? Triangle{x, y, z} : Triangle{x, z, y});
    }
  }
  for (const TriangleMesh& mesh : {box, octahedron}) {
    const WindingNumberEvaluator evaluator(mesh);
    const NodeSet inside = nodes_inside(evaluator, Rule{}, lattice);
    const std::optional<FinishedSurface> made = mesh_as_surface({mesh, evaluator, inside, {}});
    ASSERT_TRUE(made);
    EXPECT_TRUE(faults_of(made->surface.mesh, inside).none());
    EXPECT_EQ(made->surface.mesh.triangles.size(), mesh.triangles.size());
  }
}

TEST(MeshAsSurface, MergesFacesOfAPlane) {
  std::vector<std::array<int, 3>> cells;
  for (int n = 0; n < 27; ++n) cells.push_back({n % 3, n / 3 % 3, n / 9});
  const TriangleMesh box = test::cells_mesh(cells);
  EXPECT_GT(box.triangles.size(), 50U);
  const std::optional<FinishedSurface> made = kept(turned(box), 30);
  ASSERT_TRUE(made);
  EXPECT_EQ(made->surface.mesh.triangles.size(), 12U);
  for (std::size_t face = 0; face < 12; ++face) {
    const SourcePlane plane = source_plane(turned(box), made->surface.sources[face]);
    for (const std::uint32_t v : made->surface.mesh.triangles[face])
      EXPECT_LT(std::abs(plane.height(made->surface.mesh.vertices[v])), 4e-15);  // some roundings of 4
  }
}

TEST(MeshAsSurface, IsNoneWithOtherNodes) {
  const TriangleMesh box = turned(test::box_mesh({0, 0, 0}, {1, 1, 1}));
  NodeSet inside = nodes_of(box, 12);
  const WindingNumberEvaluator evaluator(box);
  ASSERT_TRUE(mesh_as_surface({box, evaluator, inside, {}}));
  NodeSet one(inside.lattice());
  one.insert(2, 2, 2);
  inside.flip(one);
  EXPECT_FALSE(mesh_as_surface({box, evaluator, inside, {}}));
}

TEST(MeshAsSurface, IsNoneOfFineMeshes) {
  const TriangleMesh fine = test::sphere(40);
  EXPECT_FALSE(kept(fine, 4));
  EXPECT_FALSE(kept(fine, 8));
  EXPECT_TRUE(kept(fine, 40));
  // Only what is left after merging counts.
  std::vector<std::array<int, 3>> cells;
  constexpr int kSide = 13;
  for (int n = 0; n < kSide * kSide * kSide; ++n) cells.push_back({n % kSide, n / kSide % kSide, n / kSide / kSide});
  const TriangleMesh box = turned(test::cells_mesh(cells));
  const NodeSet inside = nodes_of(box, 5);
  EXPECT_GT(box.triangles.size(), 12 * mixed_cells(inside));
  EXPECT_EQ(kept(box, 5).value().surface.mesh.triangles.size(), 12U);
}

TEST(MeshAsSurface, IsNoneWhereItWouldBeAnotherSurface) {
  const TriangleMesh ball = test::sphere(6);
  EXPECT_FALSE(kept(ball, 20, {.rule = {}, .thickness = 0.01}));
  EXPECT_FALSE(kept(ball, 20, {.rule = {}, .merge_planes = false}));
}

TEST(MeshAsSurface, IsRoundedToSinglePrecision) {
  const TriangleMesh ball = test::sphere(6);
  const std::optional<FinishedSurface> made = kept(ball, 20, {.rule = {}, .precision = CoordinatePrecision::kSingle});
  ASSERT_TRUE(made);
  TriangleMesh rounded = ball;
  round_to(CoordinatePrecision::kSingleNotAbove, rounded.vertices);
  EXPECT_EQ(sorted_vertices(made->surface.mesh), sorted_vertices(rounded));
  // Where floats are a tenth of a unit apart, vertices meet.
  const TriangleMesh far = test::moved(ball, {1, 1, 1}, {1e6, 0, 0});
  EXPECT_FALSE(kept(far, 20, {.rule = {}, .precision = CoordinatePrecision::kSingle}));
  EXPECT_TRUE(kept(far, 20));
  // A contour is refused so far from the origin; floats that are those of the mesh need no margin.
  const TriangleMesh whole = test::box_mesh({1e7, 0, 0}, {1e7 + 64, 64, 64});
  EXPECT_TRUE(kept(whole, 200, {.rule = {}, .precision = CoordinatePrecision::kSingle}));
}

// As lattices start at the lowest corner of a mesh's box, nodes lie in its lowest planes, and may in any other.
TEST(MeshAsSurface, KeepsNodesOnTheirSidesOfPlanesInSinglePrecision) {
  test::Random random(5);
  int moved_by_nearest = 0;
  for (int n = 0; n < 20; ++n) {
    const auto decimal = [&](double most) { return std::round(test::uniform(random, 0.1, most) * 1e6) / 1e6; };
    const Vec3 lower{-decimal(2), -decimal(2), -decimal(2)}, size{decimal(3), decimal(3), decimal(3)};
    const TriangleMesh box = test::box_mesh(lower, lower + size);
    const TriangleMesh beside = test::box_mesh({lower.x + size.x, lower.y, lower.z}, lower + 2.0 * size);
    for (const TriangleMesh& mesh : {box, test::joined(box, beside)}) {
      const Lattice lattice{lower, 0.125 * size, {-1, -1, -1}, {19, 19, 19}};
      const WindingNumberEvaluator evaluator(mesh);
      const NodeSet inside = nodes_inside(evaluator, {}, lattice);
      TriangleMesh nearest = box;
      round_to(CoordinatePrecision::kSingle, nearest.vertices);
      if (mesh.triangles.size() == 12U && !faults_of(nearest, inside).none()) ++moved_by_nearest;
      const auto made =
          mesh_as_surface({mesh, evaluator, inside, {.rule = {}, .precision = CoordinatePrecision::kSingle}});
      ASSERT_TRUE(made) << n;
      EXPECT_TRUE(faults_of(made->surface.mesh, inside).none()) << n;
    }
  }
  EXPECT_GT(moved_by_nearest, 10);
}

TEST(MeshAsSurface, IsSimplified) {
  const TriangleMesh ball = test::sphere(16);
  SurfaceOptions options;
  options.simplify = 0.02;
  const std::optional<FinishedSurface> made = kept(ball, 40, options);
  ASSERT_TRUE(made);
  EXPECT_TRUE(made->simplified);
  EXPECT_FALSE(holds_all(*made));
  EXPECT_LT(made->surface.mesh.triangles.size(), ball.triangles.size() - 50);
  std::vector<double> distances(ball.vertices.size());
  DistanceEvaluator(made->surface.mesh).evaluate(ball.vertices, distances);
  EXPECT_LE(std::ranges::max(distances), 0.02);
  EXPECT_GT(std::ranges::max(distances), 0.001);  // else nothing has been simplified
  options.simplify = 1e-20;
  const std::optional<FinishedSurface> left = kept(ball, 40, options);
  ASSERT_TRUE(left);
  EXPECT_TRUE(left->bound_too_small || left->simplified);
  EXPECT_EQ(left->surface.mesh.triangles.size(), ball.triangles.size());
}

TEST(MeshAsSurface, IsTheSameInEveryUnitOfLength) {
  const TriangleMesh mesh = turned(test::joined(finned(0.3, 0.4), box_at(1.6, 0.4)));
  SurfaceOptions options;
  options.simplify = 0.01;
  const std::optional<FinishedSurface> expected = kept(mesh, 40, options);
  ASSERT_TRUE(expected);
  for (const int exponent : {-900, -70, 70, 900}) {
    const double unit = std::ldexp(1.0, exponent);
    options.simplify = 0.01 * unit;
    const std::optional<FinishedSurface> made = kept(test::moved(mesh, {unit, unit, unit}, {}), 40, options);
    ASSERT_TRUE(made) << exponent;
    EXPECT_EQ(made->surface.mesh.triangles, expected->surface.mesh.triangles) << exponent;
    EXPECT_EQ(made->surface.mesh.vertices, test::moved(expected->surface.mesh, {unit, unit, unit}, {}).vertices);
  }
}

}  // namespace
}  // namespace raycone
