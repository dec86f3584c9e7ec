#include "core/filling/mesh_as_surface.h"
#include "core/certificate/border_components.h"
#include "core/mesh/components.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <tuple>
#include <vector>

#include "core/cells/source_plane.h"
#include "core/cells/surface_cells.h"
#include "core/cells/surface_mesh.h"
#include "core/certificate/certificate.h"
#include "core/data/vertex_precision.h"
#include "core/distance/distance.h"
#include "core/filling/seen_by_nodes.h"
#include "core/mesh/exterior_edges.h"
#include "core/mesh/used_part.h"
#include "core/mesh/weld.h"
#include "tests/core/surface_cases.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::bitten_sphere;

// By no angle that makes coordinates agree.
TriangleMesh turned(TriangleMesh mesh) {
  const double c = std::cos(0.7), s = std::sin(0.7), d = std::cos(1.1), e = std::sin(1.1);
  for (Vec3& v : mesh.vertices) {
    v = {c * v.x - s * v.y, s * v.x + c * v.y, v.z};
    v = {v.x, d * v.y - e * v.z, e * v.y + d * v.z};
  }
  return mesh;
}

// About that many samples along the longest side, half a voxel from the box of the mesh, and a layer around.
Lattice lattice_around(const TriangleMesh& mesh, double side) {
  const Box box = bounding_box(mesh);
  const Vec3 size = box.upper - box.lower;
  const double h = std::max({size.x, size.y, size.z}) / side;
  Lattice lattice{box.lower - Vec3{h / 2, h / 2, h / 2}, {h, h, h}, {-1, -1, -1}, {}};
  for (int axis = 0; axis < 3; ++axis)
    lattice.counts[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(std::ceil(size[axis] / h)) + 5;
  return lattice;
}

NodeSet nodes_of(const TriangleMesh& mesh, double side, const Rule& rule = {}) {
  return nodes_inside(WindingNumberEvaluator(mesh), rule, lattice_around(mesh, side));
}

// Of the mesh, with what it must be where there is one.
std::optional<FinishedSurface> kept(const TriangleMesh& mesh, double side, const SurfaceOptions& options = {}) {
  const NodeSet inside = nodes_of(mesh, side, options.rule);
  EXPECT_FALSE(inside.empty());
  EXPECT_FALSE(inside.reaches_border());
  const WindingNumberEvaluator evaluator(mesh);
  std::optional<FinishedSurface> made = mesh_as_surface(mesh, evaluator, inside, options);
  if (made) {
    EXPECT_TRUE(faults_of(made->surface.mesh, inside).none());
    std::vector<Vec3> rounded = made->surface.mesh.vertices;
    round_to(VertexPrecision::kSingle, rounded);
    EXPECT_TRUE(options.precision == VertexPrecision::kDouble || rounded == made->surface.mesh.vertices);
    EXPECT_EQ(made->surface.sources.size(), made->surface.mesh.triangles.size());
  }
  return made;
}

bool holds_all(const FinishedSurface& made) {
  return made.own && !made.own->held.empty() &&
         std::ranges::all_of(made.own->held, [](bool is_held) { return is_held; });
}

double volume_of(const TriangleMesh& mesh) {
  double volume = 0.0;
  for (const auto& [a, b, c] : mesh.triangles)
    volume += dot(mesh.vertices[a], cross(mesh.vertices[b], mesh.vertices[c])) / 6.0;
  return volume;
}

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
  round_to(VertexPrecision::kSingle, mesh.vertices);
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

std::vector<Vec3> sorted_vertices(const TriangleMesh& mesh) {
  std::vector<Vec3> vertices = mesh.vertices;
  std::ranges::sort(vertices, {}, [](const Vec3& v) { return std::tuple(v.x, v.y, v.z); });
  return vertices;
}

// An upright prism over a polygon that is star-shaped from its first corner, counter-clockwise.
TriangleMesh prism(const std::vector<std::array<double, 2>>& corners, double height) {
  const auto n = static_cast<std::uint32_t>(corners.size());
  TriangleMesh mesh;
  for (const double z : {0.0, height}) {
    for (const auto& [x, y] : corners) mesh.vertices.push_back({x, y, z});
  }
  for (std::uint32_t i = 1; i + 1 < n; ++i) {
    mesh.triangles.push_back({0, i + 1, i});
    mesh.triangles.push_back({n, n + i, n + i + 1});
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    mesh.triangles.push_back({i, next, n + next});
    mesh.triangles.push_back({i, n + next, n + i});
  }
  return mesh;
}

TriangleMesh blade(double degrees) {
  const double half = std::tan(degrees / 360.0 * std::numbers::pi);
  return prism({{0.0, 0.0}, {1.0, -half}, {1.0, half}}, 1.0);
}

// A block with a fin of this thickness and length; the block is 1 by 1 by 1.
TriangleMesh finned(double thickness, double length) {
  return prism({{0.0, 0.0}, {1.0 + length, 0.0}, {1.0 + length, thickness}, {1.0, thickness}, {1.0, 1.0}, {0.0, 1.0}},
               1.0);
}

TriangleMesh box_at(double x, double size, bool outward = true) {
  const TriangleMesh box = test::box_mesh({x, 0.3, 0.4}, {x + size, 0.3 + size, 0.4 + size});
  return outward ? box : test::reversed(box);
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
  const TriangleMesh cavity = test::joined(test::box_mesh({0, 0, 0}, {1, 1, 1}), box_at(0.2, 0.4, false));
  for (const TriangleMesh& mesh : {test::box_mesh({0, 0, 0}, {1, 2, 3}), weld(test::sphere(6), {}), blade(60), blade(5),
                                   cavity, test::joined(box_at(0, 0.5), box_at(0.6, 0.3))}) {
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
    const std::optional<FinishedSurface> made = mesh_as_surface(mesh, evaluator, inside, {});
    ASSERT_TRUE(made);
    EXPECT_TRUE(faults_of(made->surface.mesh, inside).none());
    EXPECT_EQ(made->surface.mesh.triangles.size(), mesh.triangles.size());
  }
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

// Without faces in the middle of the box, at the end of a side, or of a sphere's top.
TriangleMesh without(TriangleMesh mesh, const Box& box) {
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    const Vec3 middle = (1.0 / 3.0) * (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]);
    for (int axis = 0; axis < 3; ++axis) {
      if (middle[axis] < box.lower[axis] || middle[axis] > box.upper[axis]) return false;
    }
    return true;
  });
  return mesh;
}

TEST(MeshAsSurface, ClosesHolesAlongTheThreshold) {
  const TriangleMesh sphere = weld(test::sphere(10), {});
  for (const TriangleMesh& mesh :
       {test::open_box(), test::joined(box_at(2, 0.5), test::open_box()), without(sphere, {{-2, -2, 0.8}, {2, 2, 2}}),
        without(sphere, {{0.2, 0.1, 0.3}, {2, 2, 0.8}})}) {
    for (const VertexPrecision precision : {VertexPrecision::kDouble, VertexPrecision::kSingle}) {
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
    const std::optional<FinishedSurface> made = mesh_as_surface(boxes, evaluator, inside, {.rule = odd});
    ASSERT_TRUE(made) << voxel;
    EXPECT_TRUE(faults_of(made->surface.mesh, inside).none());
    EXPECT_NEAR(volume_of(made->surface.mesh), 18.0, 1e-7);
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
      const std::optional<FinishedSurface> made = mesh_as_surface(box, evaluator, inside, {});
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

// Where the threshold is not along what could close a hole: in a ring around the inside of a short pipe, and where a
// sheet has nothing inside but what it is near to.
TEST(MeshAsSurface, IsNoneOfMeshesThatAreMostlyHole) {
  const TriangleMesh pipe =
      without(without(weld(test::sphere(10), {}), {{-2, -2, 0.4}, {2, 2, 2}}), {{-2, -2, -2}, {2, 2, -0.4}});
  EXPECT_FALSE(kept(turned(pipe), 20));
}

// Of a mesh with faults, or that is not what the rule asks for, the border. Parts that touch are apart by 2^-30 of a
// voxel, a twentieth, or 32 roundings to float, 4e-6: some times that, for the areas of the parts.
void expect_volume(const TriangleMesh& mesh, double volume, const Rule& rule = {}) {
  for (const VertexPrecision precision : {VertexPrecision::kDouble, VertexPrecision::kSingle}) {
    const bool is_single = precision == VertexPrecision::kSingle;
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
  expect_volume(test::joined(box, box_at(1.5, 0.4, false)), 1.064, {RuleKind::kNonzero});
  expect_volume(test::joined(box, box_at(0.2, 0.4)), 0.936, {RuleKind::kOdd});
  expect_volume(weld(test::joined(box, box), {}), 1.0);
  expect_volume(weld(test::joined(box, test::box_mesh({1, 0, 0}, {2, 1, 1})), {}), 2.0);  // they share a side
  expect_volume(test::joined(box, test::box_mesh({1, 0.2, 0.2}, {2, 0.7, 1.4})), 1.6);    // a part of one
  expect_volume(test::cells_mesh({{0, 0, 0}, {1, 1, 0}}), 2.0);                           // an edge
  expect_volume(test::cells_mesh({{0, 0, 0}, {1, 1, 1}}), 2.0);                           // a corner
  expect_volume(test::cells_mesh({{0, 0, 0}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}}), 4.0);     // all of these
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

// A bubble so small that no sample is in it, but next to the side of the box, so that cells there are of both kinds.
TEST(MeshAsSurface, LooksIntoComponentsWithoutSamples) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  for (const bool outward : {false, true}) {
    for (const double x : {0.9996, 1.0001}) {
      const TriangleMesh mesh = turned(test::joined(box, box_at(x, 0.0003, outward)));
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
  const TriangleMesh within = turned(box_at(0.2, 0.4)), beside = turned(box_at(1.5, 0.4, false));
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

TEST(MeshAsSurface, IsNoneWithOtherNodes) {
  const TriangleMesh box = turned(test::box_mesh({0, 0, 0}, {1, 1, 1}));
  NodeSet inside = nodes_of(box, 12);
  const WindingNumberEvaluator evaluator(box);
  ASSERT_TRUE(mesh_as_surface(box, evaluator, inside, {}));
  NodeSet one(inside.lattice());
  one.insert(2, 2, 2);
  inside.flip(one);
  EXPECT_FALSE(mesh_as_surface(box, evaluator, inside, {}));
}

// Above a box without top w is a bit more than 0, so behind a sheet there it is above 1/2. A sample is there, which the
// sheet's caps leave outside.
TEST(MeshAsSurface, HasIslandsAroundNodesBehindSheets) {
  TriangleMesh mesh = test::open_box();
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {{0.4, 0.4, 2.105}, {0.8, 0.4, 2.105}, {0.6, 0.8, 2.105}});
  mesh.triangles.push_back({first, first + 1, first + 2});
  const Lattice lattice{{-0.4, -0.4, -0.4}, {0.25, 0.25, 0.25}, {0, 0, 0}, {10, 10, 13}};
  const WindingNumberEvaluator evaluator(mesh);
  const NodeSet inside = nodes_inside(evaluator, {}, lattice);
  ASSERT_TRUE(inside.holds(4, 4, 10));
  const std::optional<FinishedSurface> made = mesh_as_surface(mesh, evaluator, inside, {});
  ASSERT_TRUE(made);
  EXPECT_TRUE(faults_of(made->surface.mesh, inside).none());
  EXPECT_EQ(components_of(made->surface.mesh).count, 2U);
  EXPECT_EQ(std::ranges::count(made->own->held, true), 10);
  EXPECT_GT(made->own->left_out_of_all, 0.0);  // the rest of what is behind the sheet
}

// Beyond 2^64 the mesh is scaled. Of so many holes, evaluators differ by what they are made for.
TEST(MeshAsSurface, IsTheSameInEveryUnitWithTwoEvaluators) {
  test::Random random(8);
  TriangleMesh sieve = weld(test::sphere(40), {});
  std::erase_if(sieve.triangles, [&](const Triangle&) { return test::uniform(random, 0.0, 1.0) < 0.1; });
  const auto made = [&](double unit) {
    const TriangleMesh mesh = test::moved(sieve, {unit, unit, unit}, {0, 0, 0});
    const double h = 0.1 * unit, first = -1.25 * unit;
    const Lattice lattice{{first, first, first}, {h, h, h}, {0, 0, 0}, {26, 26, 26}};
    constexpr double kPoints = 1e6;
    const WindingNumberEvaluator fine(mesh, {.accuracy = {.tolerance = 1e-6, .samples = kPoints, .points = kPoints}});
    const WindingNumberEvaluator rough(mesh, {.accuracy = {.tolerance = 1e-5, .samples = kPoints, .points = kPoints}});
    std::optional<FinishedSurface> surface =
        mesh_as_surface(mesh, FineAndRough(fine, rough), nodes_inside(rough, {}, lattice), {});
    return surface ? test::moved(surface->surface.mesh, {1 / unit, 1 / unit, 1 / unit}, {0, 0, 0}) : TriangleMesh();
  };
  const TriangleMesh expected = made(1.0);
  ASSERT_FALSE(expected.triangles.empty());
  for (const double unit : {0x1p100, 0x1p-100}) EXPECT_EQ(made(unit).vertices, expected.vertices);
}

// Rounding may turn flat components over: beside a box, or within it.
TEST(BorderComponents, AreWithoutThoseThatAreTurnedOver) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const auto small = [](double x, bool turned) {
    const TriangleMesh other = test::box_mesh({x, 0.2, 0.2}, {x + 0.1, 0.3, 0.3});
    return turned ? test::reversed(other) : other;
  };
  const auto left = [&](double x, bool turned) {
    SurfaceMesh surface{weld(test::joined(box, small(x, turned)), {}), {}};
    surface.sources.resize(surface.mesh.triangles.size(), 0);
    EXPECT_TRUE(keep_border(surface, Rule{}));
    return surface.sources.size();
  };
  EXPECT_EQ(left(2.0, false), 24U);
  EXPECT_EQ(left(2.0, true), 12U);
  EXPECT_EQ(left(0.2, true), 24U);  // a cavity
  EXPECT_EQ(left(0.2, false), 12U);
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

TEST(MeshAsSurface, IsNoneOfFineMeshes) {
  const TriangleMesh fine = weld(test::sphere(40), {});
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
  const TriangleMesh ball = weld(test::sphere(6), {});
  EXPECT_FALSE(kept(ball, 20, {.rule = {}, .thickness = 0.01}));
  EXPECT_FALSE(kept(ball, 20, {.rule = {}, .merge_planes = false}));
}

TEST(MeshAsSurface, IsRoundedToSinglePrecision) {
  const TriangleMesh ball = weld(test::sphere(6), {});
  const std::optional<FinishedSurface> made = kept(ball, 20, {.rule = {}, .precision = VertexPrecision::kSingle});
  ASSERT_TRUE(made);
  TriangleMesh rounded = ball;
  round_to(VertexPrecision::kSingle, rounded.vertices);
  EXPECT_EQ(sorted_vertices(made->surface.mesh), sorted_vertices(rounded));
  // Where floats are a tenth of a unit apart, vertices meet.
  const TriangleMesh far = test::moved(ball, {1, 1, 1}, {1e6, 0, 0});
  EXPECT_FALSE(kept(far, 20, {.rule = {}, .precision = VertexPrecision::kSingle}));
  EXPECT_TRUE(kept(far, 20));
  // A contour is refused so far from the origin; floats that are those of the mesh need no margin.
  const TriangleMesh whole = test::box_mesh({1e7, 0, 0}, {1e7 + 64, 64, 64});
  EXPECT_TRUE(kept(whole, 200, {.rule = {}, .precision = VertexPrecision::kSingle}));
}

TEST(MeshAsSurface, IsSimplified) {
  const TriangleMesh ball = weld(test::sphere(16), {});
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

// What is judged at parts of triangles, at all places of a lattice.
TEST(SeenByNodes, TellsHowFarTrianglesAreFromNodesOfBothKinds) {
  const Lattice lattice{{0, 0, 0}, {1, 1, 1}, {0, 0, 0}, {30, 30, 30}};
  NodeSet inside(lattice);
  inside.insert(15, 15, 15);
  const auto is_seen = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    return sights_of(inside, {{{0, 1, 2}}}, {a, b, c}).front() == Sight::kWhole;
  };
  const Vec3 at{15, 15, 15};
  for (double far = 0.0; far < 14.0; far += 0.5) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {-1.0, 1.0}) {
        Vec3 to = at;
        to[axis] += sign * far;
        const Vec3 beside = to + Vec3{0.1, 0.1, 0.1};
        const bool seen = is_seen(at, to, beside);
        if (far <= 4.0) {
          EXPECT_TRUE(seen) << far << ' ' << axis;
        }
        if (far >= 11.0) {  // eight and a cell, and half of a part
          EXPECT_FALSE(seen) << far << ' ' << axis;
        }
      }
    }
  }
  EXPECT_FALSE(is_seen({17.5, 15, 15}, {18, 15, 15}, {17.5, 16, 15}));  // near, but in no such cell
  EXPECT_TRUE(is_seen({16.5, 15, 15}, {15.5, 15, 15}, {15.5, 16, 15}));
  for (const double beyond : {-1e-9, 29.001, 1e300})
    EXPECT_FALSE(is_seen(at, {15, beyond, 15}, {16, 15, 15})) << beyond;
}

}  // namespace
}  // namespace raycone
