// The closed surface between nodes: closed, embedded and where the mesh is.
#include "core/surface/surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/cells/surface_cells.h"
#include "core/cells/unit_normal.h"
#include "core/certificate/certificate.h"
#include "core/distance/distance.h"
#include "core/filling/mesh_as_surface.h"
#include "core/mesh/exterior_edges.h"
#include "core/mesh/mesh_statistics.h"
#include "core/mesh/weld.h"
#include "core/surface/surface_measures.h"
#include "tests/core/surface_cases.h"
#include "tests/support/shapes.h"
#include "tests/support/values.h"

namespace raycone {
namespace {

using test::cylinder;
using test::largest_distance_of;
using test::Random;
using test::rotated;
using test::surface_of;
using test::uniform;

// A wedge with an angle of some degrees.
TriangleMesh wedge() {
  TriangleMesh mesh = test::box_mesh({0, 0, 0}, {3, 1, 1});
  for (Vec3& p : mesh.vertices) {
    if (p.x > 1.0) p.z = p.z * 0.25;
  }
  return mesh;
}

// Far from 1, squares of areas over- or underflow.
TEST(Surface, IsTheSameInEveryUnitOfLength) {
  TriangleMesh ball = test::sphere(8);
  for (Vec3& v : ball.vertices) v = (1.0 + 0.1 * std::sin(5 * v.x + 3 * v.y)) * v;
  TriangleMesh cup = ball;
  std::erase_if(cup.triangles, [&](const Triangle& t) { return cup.vertices[t[0]].z > 0.6; });
  for (const TriangleMesh& mesh : {weld(ball, {}), weld(cup, {})}) {
    const std::size_t unsimplified = surface_of(mesh, 20).surface.mesh.triangles.size();
    for (const double simplify : {0.0, 0.02}) {
      SurfaceOptions options;
      options.simplify = simplify;
      const TriangleMesh expected = surface_of(mesh, 20, options).surface.mesh;
      if (simplify > 0.0) {
        EXPECT_LT(expected.triangles.size(), unsimplified);  // else nothing has been tested
      }
      for (const int exponent : {-850, -300, -100, -60, 60, 100, 300, 900}) {
        const double unit = std::ldexp(1.0, exponent);
        options.simplify = simplify * unit;
        const TriangleMesh made = surface_of(test::moved(mesh, {unit, unit, unit}, {}), 20, options).surface.mesh;
        EXPECT_EQ(made.triangles, expected.triangles) << exponent;
        EXPECT_EQ(made.vertices, test::moved(expected, {unit, unit, unit}, {}).vertices) << exponent;
      }
    }
  }
}

// How many of the points are within 1e-9 voxels of the mesh, which is about the margin.
double part_at(const std::vector<Vec3>& points, const TriangleMesh& mesh, double voxel) {
  const std::vector<double> distances = test::values_of(DistanceEvaluator(mesh), points);
  const auto near = std::ranges::count_if(distances, [&](double d) { return d <= 2e-9 * voxel; });
  return static_cast<double>(near) / static_cast<double>(points.size());
}

std::vector<Vec3> points_of_edges(const TriangleMesh& mesh) {
  std::vector<Vec3> points;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 &a = mesh.vertices[t[i]], &b = mesh.vertices[t[(i + 1) % 3]];
      for (int n = 1; n < 100; ++n) points.push_back(a + (n / 100.0) * (b - a));
    }
  }
  return points;
}

// Whether the tetrahedron that holds a point has nodes of both kinds: there the lattice resolves a sharp edge.
bool is_resolved(const Vec3& p, const NodeSet& nodes) {
  const Lattice& lattice = nodes.lattice();
  std::array<std::int64_t, 3> node{};
  std::array<std::pair<double, std::size_t>, 3> order;
  for (int axis = 0; axis < 3; ++axis) {
    const auto n = static_cast<std::size_t>(axis);
    const double at =
        (p[axis] - lattice.origin[axis]) / lattice.spacing[axis] - static_cast<double>(lattice.index_min[n]);
    node[n] = static_cast<std::int64_t>(std::floor(at));
    order[n] = {std::floor(at) - at, n};
  }
  std::ranges::sort(order);
  int inside = nodes.holds(node[0], node[1], node[2]) ? 1 : 0;
  for (const auto& [fraction, axis] : order) {
    ++node[axis];
    inside += nodes.holds(node[0], node[1], node[2]) ? 1 : 0;
  }
  return inside > 0 && inside < 4;
}

// All of it, at any angle, between outside nodes, too, where the lattice does not see an edge: a quarter of its length
// or so. Of the cylinder's 72 edges some may be left where three meet that no single point of a gap is on.
TEST(Surface, KeepsSharpEdges) {
  for (const TriangleMesh& shape : {test::box_mesh({0, 0, 0}, {1, 1.5, 0.7}), wedge(), cylinder()}) {
    const bool is_round = shape.triangles.size() > 12;
    const TriangleMesh mesh = rotated(shape);
    const auto [surface, lattice] = surface_of(mesh, 24, {.rule = {}, .merge_planes = false});
    const double h = lattice.spacing.x;
    const NodeSet nodes = nodes_inside(WindingNumberEvaluator(mesh), Rule{}, lattice);
    std::vector<Vec3> all = points_of_edges(mesh), resolved;
    std::ranges::copy_if(all, std::back_inserter(resolved), [&](const Vec3& p) { return is_resolved(p, nodes); });
    EXPECT_LT(resolved.size(), 0.95 * static_cast<double>(all.size()));
    EXPECT_GE(part_at(resolved, surface.mesh, h), is_round ? 0.98 : 0.999);
    EXPECT_GE(part_at(all, surface.mesh, h), is_round ? 0.98 : 0.999);
    EXPECT_LT(largest_distance_of(all, surface.mesh), is_round ? 0.2 * h : 4e-9 * h);
    // The margin moves a vertex by less than two margins along each axis.
    EXPECT_LT(largest_distance_of(surface.mesh.vertices, mesh), 4e-9 * h);
    const double volume = mesh_statistics(mesh).signed_volume.value_or(0.0);
    EXPECT_NEAR(mesh_statistics(surface.mesh).signed_volume.value_or(0.0), volume, 0.01 * volume);
  }
}

// A lattice whose nodes are not in the planes of a box sees some of its edges pass between outside nodes, from end to
// end.
TEST(Surface, KeepsEdgesThatPassBetweenOutsideNodes) {
  const TriangleMesh mesh = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const std::vector<Vec3> edges = points_of_edges(mesh);
  for (const Vec3& shift : {Vec3{0.03, 0.11, 0.07}, Vec3{0.12, 0.02, 0.05}}) {
    const double h = 1.0 / 20;
    const Lattice lattice{-1.0 * shift, {h, h, h}, {-1, -1, -1}, {30, 30, 30}};
    const WindingNumberEvaluator evaluator(mesh);
    const NodeSet nodes = nodes_inside(evaluator, Rule{}, lattice);
    const auto resolved = std::ranges::count_if(edges, [&](const Vec3& p) { return is_resolved(p, nodes); });
    EXPECT_LT(resolved, 0.9 * static_cast<double>(edges.size()));  // what tetrahedra alone can keep
    for (const bool merged : {true, false}) {
      const SurfaceMesh surface =
          closed_surface({mesh, evaluator, nodes, {.rule = {}, .merge_planes = merged}}).surface;
      EXPECT_TRUE(faults_of(surface.mesh, nodes).none());
      EXPECT_EQ(part_at(edges, surface.mesh, h), 1.0);
      if (merged) {
        EXPECT_EQ(surface.mesh.triangles.size(), 12U);
      }
    }
  }
}

// At arbitrary angles, a quarter of each edge passes so.
TEST(Surface, KeepsEdgesOfTurnedParts) {
  for (const TriangleMesh& shape : {test::box_mesh({0, 0, 0}, {1, 1.5, 0.7}), wedge()}) {
    const TriangleMesh mesh = rotated(shape);
    const auto [surface, lattice] = surface_of(mesh, 24);
    EXPECT_EQ(surface.mesh.triangles.size(), 12U);
    EXPECT_EQ(part_at(points_of_edges(mesh), surface.mesh, lattice.spacing.x), 1.0);
    EXPECT_LE(largest_distance_of(surface.mesh.vertices, mesh), 1e-8 * lattice.spacing.x);
    const double volume = mesh_statistics(mesh).signed_volume.value_or(0.0);
    EXPECT_NEAR(mesh_statistics(surface.mesh).signed_volume.value_or(0.0), volume, 1e-8 * volume);
  }
}

// By an angle about an axis.
TriangleMesh turned(TriangleMesh mesh, const Vec3& axis, double angle) {
  const Vec3 u = (1 / norm(axis)) * axis;
  for (Vec3& p : mesh.vertices) {
    const Vec3 along = dot(u, p) * u;
    p = along + std::cos(angle) * (p - along) + std::sin(angle) * cross(u, p);
  }
  return mesh;
}

// Of three cubes and of four around a corner, and of a cross, where three planes meet in six faces. Gaps there cannot
// be filled by what is around them alone: faces of the contour reach beyond the corner.
TEST(Surface, KeepsConcaveCorners) {
  using Cells = std::vector<std::array<int, 3>>;
  const Cells step{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, pit{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
      cross_of_cells{{1, 1, 1}, {0, 1, 1}, {2, 1, 1}, {1, 0, 1}, {1, 2, 1}, {1, 1, 0}, {1, 1, 2}};
  const Cells chain{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}};
  for (const Cells& cells : {step, pit, cross_of_cells, chain}) {
    for (int n = 0; n < 24; ++n) {
      const TriangleMesh mesh =
          turned(test::cells_mesh(cells), {1.0, 0.3 * (n % 8) - 1.0, 0.7 - 0.1 * n}, 0.4 + 0.9 * n);
      const auto [surface, lattice] = surface_of(mesh, 18 + n);
      // Points are kept off nodes by 4 2^-30 voxels at most.
      EXPECT_LE(largest_distance_of(points_of_edges(mesh), surface.mesh), 4e-9 * lattice.spacing.x) << n;
      EXPECT_LE(largest_distance_of(surface.mesh.vertices, mesh), 4e-9 * lattice.spacing.x) << n;
      // Faces may still lie across a notch, with all of their edges on the mesh.
      const double volume = mesh_statistics(mesh).signed_volume.value_or(0.0);
      EXPECT_NEAR(mesh_statistics(surface.mesh).signed_volume.value_or(0.0), volume, 1e-8 * volume) << n;
    }
  }
}

// Two pyramids that touch with their tips.
TriangleMesh hourglass() {
  return {{{0, 0, 0}, {1, 0, 1}, {0, 1, 1}, {-1, 0, 1}, {0, -1, 1}, {1, 0, -1}, {0, 1, -1}, {-1, 0, -1}, {0, -1, -1}},
          {{0, 2, 1},
           {0, 3, 2},
           {0, 4, 3},
           {0, 1, 4},
           {1, 2, 3},
           {1, 3, 4},
           {0, 5, 6},
           {0, 6, 7},
           {0, 7, 8},
           {0, 8, 5},
           {5, 7, 6},
           {5, 8, 7}}};
}

// At the tip eight faces lie in four planes, and those of two faces that meet in an edge leave a line to choose from.
TEST(Surface, KeepsTipsThatTouch) {
  for (int n = 0; n < 24; ++n) {
    const TriangleMesh mesh = turned(hourglass(), {1.0, 0.3 * (n % 8) - 1.0, 0.7 - 0.1 * n}, 0.4 + 0.9 * n);
    const auto [surface, lattice] = surface_of(mesh, 24, {.rule = {}, .merge_planes = false});
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vec3& p : surface.mesh.vertices) nearest = std::min(nearest, norm(p - mesh.vertices[0]));
    // The margin moves a vertex by less than two margins along each axis.
    EXPECT_LT(nearest, 4e-9 * lattice.spacing.x) << n;
  }
}

// As floats are, or six or seven digits of text: triangles of one plane are no more in one plane then.
TEST(Surface, KeepsEdgesAndFacesOfPartsWithRoundedCoordinates) {
  const auto as_float = [](double x) { return static_cast<double>(static_cast<float>(x)); };
  const auto as_text = [](const char* format) {
    return [format](double x) {
      std::array<char, 32> text{};
      std::snprintf(text.data(), text.size(), format, x);
      return std::strtod(text.data(), nullptr);
    };
  };
  const std::vector<std::function<double(double)>> roundings{as_float, as_text("%.6e"), as_text("%.6f"), as_text("%g")};
  int few = 0;
  for (const auto& rounded : roundings) {
    for (const TriangleMesh& shape : {test::box_mesh({0, 0, 0}, {1, 1.5, 0.7}), wedge()}) {
      TriangleMesh mesh = rotated(shape);
      for (Vec3& v : mesh.vertices) v = {rounded(v.x), rounded(v.y), rounded(v.z)};
      for (const int side : {17, 24, 33}) {
        const auto [surface, lattice] = surface_of(mesh, side);
        EXPECT_LT(largest_distance_of(points_of_edges(mesh), surface.mesh), 1e-4 * lattice.spacing.x) << side;
        EXPECT_LT(largest_distance_of(surface.mesh.vertices, mesh), 1e-4 * lattice.spacing.x) << side;
        few += surface.mesh.triangles.size() <= 24 ? 1 : 0;
      }
    }
  }
  // Faces stay around nodes that merging would put on the other side of a plane, and "%g" rounds more.
  EXPECT_GE(few, 16);
}

// The surface over the opening of a box meets the walls at the rim.
TEST(Surface, MeetsTheRimOfAHole) {
  const TriangleMesh mesh = rotated(test::open_box());
  const auto [surface, lattice] = surface_of(mesh, 24, {.rule = {}, .merge_planes = false});
  std::vector<Vec3> rim;
  for (const ExteriorEdge& edge : exterior_edges(mesh)) {
    const Vec3 &a = mesh.vertices[edge.from], &b = mesh.vertices[edge.to];
    for (int n = 1; n < 200; ++n) rim.push_back(a + (n / 200.0) * (b - a));
  }
  EXPECT_GT(part_at(rim, surface.mesh, lattice.spacing.x), 0.6);
}

// The area of the faces that have one of the triangles of a plane as their source, by planes, which all of them are in.
std::map<std::pair<int, double>, double> areas_by_plane(const SurfaceMesh& surface, const TriangleMesh& input) {
  std::map<std::pair<int, double>, double> areas;
  for (std::size_t face = 0; face < surface.sources.size(); ++face) {
    const Triangle& source = input.triangles[static_cast<std::size_t>(surface.sources[face])];
    const Vec3 &a = input.vertices[source[0]], &b = input.vertices[source[1]], &c = input.vertices[source[2]];
    const Triangle& t = surface.mesh.triangles[face];
    const Vec3 &p = surface.mesh.vertices[t[0]], &q = surface.mesh.vertices[t[1]], &r = surface.mesh.vertices[t[2]];
    const Vec3 normal = cross(q - p, r - p);
    for (int axis = 0; axis < 3; ++axis) {
      if (a[axis] == b[axis] && b[axis] == c[axis]) areas[{axis, a[axis]}] += std::sqrt(dot(normal, normal)) / 2;
    }
  }
  return areas;
}

// The lattice has nodes in the planes of the boxes, so that many lattice edges meet the mesh on its edges, where a
// point is on several triangles. The boxes overlap, too, and have parallel sides a voxel apart.
TEST(Surface, HasTheSourcesWhosePlanesItsFacesAreIn) {
  TriangleMesh mesh = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const std::map<std::pair<int, double>, double> ones{{{0, 0.0}, 1.0}, {{0, 1.0}, 1.0}, {{1, 0.0}, 1.0},
                                                      {{1, 1.0}, 1.0}, {{2, 0.0}, 1.0}, {{2, 1.0}, 1.0}};
  for (const std::int64_t side : {11, 13, 24}) {
    for (const bool merged : {true, false}) {
      const auto [surface, lattice] = surface_of(mesh, side, {.rule = {}, .merge_planes = merged});
      const auto areas = areas_by_plane(surface, mesh);
      ASSERT_EQ(areas.size(), ones.size());
      for (const auto& [plane, area] : areas) EXPECT_NEAR(area, ones.at(plane), 1e-6);
    }
  }
}

// The corners of a cube cut off, halfway along its edges.
TriangleMesh cuboctahedron() {
  TriangleMesh mesh;
  const auto add = [&](const Vec3& p, const Vec3& q, const Vec3& r) {
    const bool is_outward = dot(cross(q - p, r - p), p) > 0.0;
    test::add_triangle(mesh, p, is_outward ? q : r, is_outward ? r : q);
  };
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) add({x, y, 0}, {x, 0, z}, {0, y, z});
      add({x, 1, 0}, {x, -1, 0}, {x, 0, y});
      add({1, x, 0}, {-1, x, 0}, {0, x, y});
      add({1, 0, x}, {-1, 0, x}, {0, y, x});
    }
  }
  return weld(std::move(mesh), {});
}

// Its corners are nodes. Sharpening moves faces into the planes of others.
TEST(Surface, HasTheSourcesOfPlanesThatFacesAreMovedTo) {
  const TriangleMesh mesh = cuboctahedron();
  for (const bool merged : {true, false}) {
    const auto [surface, lattice] = surface_of(mesh, 5, {.rule = {}, .merge_planes = merged});
    for (std::size_t face = 0; face < surface.sources.size(); ++face) {
      const Triangle& t = mesh.triangles[static_cast<std::size_t>(surface.sources[face])];
      const Vec3 normal = unit_normal(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
      for (const std::uint32_t corner : surface.mesh.triangles[face]) {
        EXPECT_LT(std::abs(dot(normal, surface.mesh.vertices[corner] - mesh.vertices[t[0]])), 1e-6);  // of a voxel
      }
    }
  }
}

TEST(Surface, KeepsItsShapeWhereFacesAreMerged) {
  const TriangleMesh mesh = rotated(wedge());
  const auto [fine, lattice] = surface_of(mesh, 16, {.rule = {}, .merge_planes = false});
  const auto [merged, same_lattice] = surface_of(mesh, 16);
  EXPECT_LT(4 * merged.mesh.triangles.size(), fine.mesh.triangles.size());
  EXPECT_LE(largest_distance_of(fine.mesh.vertices, merged.mesh), 4e-9 * lattice.spacing.x);
}

TEST(Surface, OfAnAlignedBoxHasFewFaces) {
  const auto [surface, lattice] = surface_of(test::box_mesh({0, 0, 0}, {1, 1, 1}), 24);
  EXPECT_EQ(surface.mesh.triangles.size(), 12U);
}

// The border of faces that close a hole stays where it is, also in the plane of what is beside it.
TEST(Surface, KeepsTheBorderOfAHoleWhereFacesAreMerged) {
  // A box whose top has a hole that is no rectangle: what closes it is nearly in the plane of the rest of the top.
  TriangleMesh mesh = test::box_mesh({0, 0, 0}, {1, 1, 1});
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return std::ranges::all_of(t, [&](std::uint32_t v) { return mesh.vertices[v].z == 1.0; });
  });
  const std::uint32_t first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0.37, 0.61, 1}});
  mesh.triangles.insert(mesh.triangles.end(), {{first, first + 1, first + 4}, {first + 1, first + 2, first + 4}});
  const auto hole_area = [](const SurfaceMesh& surface) {
    double area = 0.0;
    for (std::size_t face = 0; face < surface.sources.size(); ++face) {
      if (surface.sources[face] != kHole) continue;
      const Triangle& t = surface.mesh.triangles[face];
      const std::vector<Vec3>& v = surface.mesh.vertices;
      const Vec3 normal = cross(v[t[1]] - v[t[0]], v[t[2]] - v[t[0]]);
      area += std::sqrt(dot(normal, normal)) / 2;
    }
    return area;
  };
  const TriangleMesh welded = weld(mesh, {});
  const auto [fine, lattice] = surface_of(welded, 20, {.rule = {}, .merge_planes = false});
  const auto [merged, same] = surface_of(welded, 20);
  EXPECT_GT(hole_area(fine), 0.1);
  EXPECT_NEAR(hole_area(merged), hole_area(fine), 1e-6);
}

// Merging goes brick by brick, of 32 voxels each: nothing of their borders is left.
TEST(Surface, OfABoxOfManyBricksHasFewFaces) {
  const auto [aligned, lattice] = surface_of(test::box_mesh({0, 0, 0}, {1, 1, 1}), 80);
  EXPECT_EQ(aligned.mesh.triangles.size(), 12U);
  const TriangleMesh mesh = rotated(test::box_mesh({0, 0, 0}, {1, 1, 1}));
  const auto [turned, turned_lattice] = surface_of(mesh, 80);
  const auto [coarse, coarse_lattice] = surface_of(mesh, 20);
  // Where edges are cut off between outside nodes, faces are left, a number for each voxel of the edges.
  EXPECT_LT(turned.mesh.triangles.size(), 6 * coarse.mesh.triangles.size());
}

// The opening of the box is in a plane of nodes, which are inside. Merged with the rim, which is at these nodes, it
// would leave some of them outside. Without what keeps faces beside these, there are twice as many.
TEST(Surface, IsMergedButAtNodesThatWouldChangeSides) {
  for (const std::int64_t side : {14, 15, 18}) {
    const auto [surface, lattice] = surface_of(test::open_box(), side);
    EXPECT_LT(surface.mesh.triangles.size(), 400U) << side;
  }
}

// Of the rim's 37 nodes, another one would be outside after each round in which those around the last stay: all rounds
// end with faults, and all 62488 faces would be left.
TEST(Surface, IsMergedWhereFaultsMoveAlongAnEdge) {
  const TriangleMesh box = test::open_box();
  const double h = 1.0 / 36.0;
  const Lattice lattice{{0, 0, 0}, {h, h, h}, {-3, -3, -3}, {43, 43, 43}};
  const WindingNumberEvaluator evaluator(box);
  const NodeSet nodes = nodes_inside(evaluator, Rule{}, lattice);
  const FinishedSurface made = closed_surface({box, evaluator, nodes, {}});
  EXPECT_TRUE(made.merged);
  EXPECT_TRUE(faults_of(made.surface.mesh, nodes).none());
  EXPECT_LT(made.surface.mesh.triangles.size(), 3000U);
}

// A box across the corners of the lattice: the planes of its sides lead through nodes, its corners are nodes. Points
// there are kept off them, so that faces between these are not quite in the planes: some nodes on them would be on the
// wrong side.
TEST(Surface, HasThePlanesOfTheMeshThroughNodes) {
  for (const double height : {0.7, 1.4142, 3.0}) {
    for (const std::int64_t side : {13, 23, 43}) {
      TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
      for (Vec3& p : box.vertices) p = {1.632993 * (p.x - p.y), 1.632993 * (p.x + p.y - 1), height * p.z};
      EXPECT_EQ(surface_of(box, side).surface.mesh.triangles.size(), 12U) << height << " at " << side;
    }
  }
}

// Three tetrahedra stand on a plane of the lattice and pass through each other: their faces meet there at points that
// are no corners.
TEST(Surface, InLevelPlanesThroughNodesHasLargeFaces) {
  const TriangleMesh mesh{{{-2, -2, 0},
                           {-2, 13, 0},
                           {5.5, 5.5, 15},
                           {13, -2, 0},
                           {16, 14, 0},
                           {16, 14, 30},
                           {31, -1, 0},
                           {31, 29, 0},
                           {0, 30, 0},
                           {15, 15, 0},
                           {15, 15, 30},
                           {30, 30, 0}},
                          {{0, 2, 1},
                           {0, 3, 2},
                           {2, 3, 1},
                           {1, 3, 0},
                           {4, 5, 7},
                           {4, 6, 5},
                           {5, 6, 7},
                           {7, 6, 4},
                           {8, 9, 10},
                           {8, 11, 9},
                           {9, 11, 10},
                           {10, 11, 8}}};
  const std::optional<double> volume = mesh_statistics(mesh).signed_volume;
  ASSERT_TRUE(volume && *volume > 0.0);
  const auto [surface, lattice] = surface_of(mesh, 82);
  EXPECT_LT(surface.mesh.triangles.size(), 40U);
}

// Oblique planes through nodes, which rounding has on either side of them.
TEST(Surface, OfPlanesThroughNodesHasTheFacesOfTheMesh) {
  const TriangleMesh tetrahedron{{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}},
                                 {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}};
  for (const TriangleMesh& mesh :
       {test::octahedron(1.0), test::octahedron(0.1), test::octahedron(0.001), tetrahedron}) {
    for (const std::int64_t samples : {24, 44, 74, 80, 84}) {
      const auto [surface, lattice] = surface_of(mesh, samples + 2);
      EXPECT_EQ(surface.mesh.triangles.size(), mesh.triangles.size()) << mesh.vertices[0].x << " at " << samples;
    }
  }
}

// The same octahedron, and in a corner of its box a block with a pit that one edge of the lattice leads through. A
// lattice that is moved does not see it.
TEST(Surface, OfPlanesThroughNodesIsWhereEdgesOfTheLatticeLeaveTheMesh) {
  const std::int64_t samples = 80;
  const double h = 2.0 / (samples - 1), x = -1 + 72 * h, top = 0.9375, rim = 0.002;
  TriangleMesh mesh = test::octahedron(1.0);
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const double low = 0.7, high = 0.95;
  for (const double z : {low, top}) {
    for (const Vec3& p : {Vec3{low, low, z}, Vec3{high, low, z}, Vec3{high, high, z}, Vec3{low, high, z}})
      mesh.vertices.push_back(p);
  }
  for (const Vec3& p : {Vec3{x - rim, x - rim, top}, Vec3{x + rim, x - rim, top}, Vec3{x + rim, x + rim, top},
                        Vec3{x - rim, x + rim, top}, Vec3{x + 1e-4, x + 2e-4, 0.93}})
    mesh.vertices.push_back(p);
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.triangles.push_back({first + a, first + b, first + c});
  };
  add(0, 2, 1);
  add(0, 3, 2);
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t j = (i + 1) % 4;
    add(i, j, 4 + j);
    add(i, 4 + j, 4 + i);
    add(4 + i, 4 + j, 8 + j);
    add(4 + i, 8 + j, 8 + i);
    add(8 + i, 8 + j, 12);
  }
  const auto [surface, lattice] = surface_of(mesh, samples + 2);
  const std::vector<Vec3> in_pit{{x, x, 0.936}};
  std::vector<double> of_mesh(1), of_surface(1);
  WindingNumberEvaluator(mesh).evaluate(in_pit, of_mesh);
  WindingNumberEvaluator(surface.mesh).evaluate(in_pit, of_surface);
  EXPECT_NEAR(of_mesh[0], 0.0, 1e-12);
  EXPECT_NEAR(of_surface[0], 0.0, 1e-12);
}

TEST(Surface, ClosesAHoleWhereTheWindingNumberPassesTheThreshold) {
  const TriangleMesh mesh = rotated(test::open_box());
  const auto [surface, lattice] = surface_of(mesh, 20);
  std::vector<Vec3> at_hole;
  for (std::size_t i = 0; i < surface.sources.size(); ++i) {
    if (surface.sources[i] == kHole) at_hole.push_back(surface.mesh.vertices[surface.mesh.triangles[i][0]]);
  }
  ASSERT_GT(at_hole.size(), 10U);
  const std::vector<double> w = test::values_of(WindingNumberEvaluator(mesh), at_hole);
  // Points next to the hole's rim are on triangles, the others within 2^-34 of an edge of the right place.
  const auto right = std::ranges::count_if(w, [](double value) { return std::abs(value - 0.5) < 1e-8; });
  EXPECT_GT(static_cast<double>(right), 0.5 * static_cast<double>(w.size()));
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(mesh), Rule{}, lattice);
  EXPECT_GT(measure_surface(surface, mesh, lattice).hole_area, 0.0);
}

TEST(Surface, InSinglePrecisionIsRightThere) {
  SurfaceOptions options;
  options.precision = CoordinatePrecision::kSingle;
  const TriangleMesh mesh = rotated(test::sphere(7));
  for (const auto& [surface, lattice] :
       {surface_of(mesh, 17, options), surface_of(test::box_mesh({0, 0, 0}, {1, 1, 1}), 17, options)}) {
    for (const Vec3& p : surface.mesh.vertices) {
      for (const double x : {p.x, p.y, p.z}) ASSERT_EQ(x, static_cast<double>(static_cast<float>(x)));
    }
  }
}

TEST(Surface, FollowsItsRule) {
  const TriangleMesh twice = test::joined(test::sphere(6), test::moved(test::sphere(6), {1, 1, 1}, {0.4, 0, 0}));
  SurfaceOptions both;
  both.rule = {RuleKind::kThreshold, 1.5};
  const double of_both = mesh_statistics(surface_of(twice, 14, both).surface.mesh).signed_volume.value_or(0.0);
  const double of_any = mesh_statistics(surface_of(twice, 14).surface.mesh).signed_volume.value_or(0.0);
  const double of_one = mesh_statistics(test::sphere(6)).signed_volume.value_or(0.0);
  // Each volume is off by what the lattice rounds: 4 % at 14 samples.
  EXPECT_NEAR(of_both + of_any, 2.0 * of_one, 0.04 * of_one);
  EXPECT_LT(of_both, 0.8 * of_one);
}

// Simplified faces may reach from the mesh into what closes a hole: these are of no triangle.
TEST(Surface, SimplifiedFacesWithASourceAreNearIt) {
  Random random(3);
  const TriangleMesh sieve = rotated(test::with_holes(test::sphere(24), random, 0.1));
  for (const double simplify : {0.05, 0.01}) {  // voxels are 0.12
    SurfaceOptions options;
    options.simplify = simplify;
    const auto [surface, lattice] = surface_of(sieve, 20, options);
    const NodeSet inside = nodes_inside(WindingNumberEvaluator(sieve), Rule{}, lattice);
    const std::optional<FinishedSurface> own = mesh_as_surface({sieve, WindingNumberEvaluator(sieve), inside, options});
    ASSERT_TRUE(own);
    for (const SurfaceMesh* made : {&surface, &own->surface}) {
      EXPECT_GT(std::ranges::count(made->sources, kHole), 5) << simplify;
      EXPECT_LE(measure_surface(*made, sieve, lattice).max_distance, simplify);
    }
  }
}

TEST(Surface, OfALatticeThatIsTooFineOrOutOfRangeIsRefused) {
  const TriangleMesh mesh = test::moved(test::box_mesh({0, 0, 0}, {1, 1, 1}), {1, 1, 1}, {1e15, 1e15, 1e15});
  EXPECT_THROW(surface_of(mesh, 8), LatticeTooFine);
  SurfaceOptions single;
  single.precision = CoordinatePrecision::kSingle;
  // So far away that 256 roundings are a fifth of a voxel: there are surfaces all the same.
  const TriangleMesh away = test::moved(test::sphere(8), {1, 1, 1}, {3000, -3000, 2000});
  const auto [surface, lattice] = surface_of(away, 9, single);
  EXPECT_TRUE(faults_of(surface.mesh, nodes_inside(WindingNumberEvaluator(away), Rule{}, lattice)).none());
  for (const double size : {1e-40, 1e-300, 1e39, 1e300}) {
    EXPECT_THROW(surface_of(test::box_mesh({0, 0, 0}, {size, size, size}), 8, single), LatticeOutOfRange) << size;
    EXPECT_NO_THROW(surface_of(test::box_mesh({0, 0, 0}, {size, size, size}), 8)) << size;
  }
  EXPECT_THROW(surface_of(test::box_mesh({0, 0, 0}, {1e-321, 1e-321, 1e-321}), 8), LatticeOutOfRange);
}

// No power of two takes both to where nothing over- or underflows.
TEST(Surface, RefusesCoordinatesTooFarApart) {
  TriangleMesh box = test::moved(test::box_mesh({0, 0, 0}, {1, 1, 1}), {0x1p400, 0x1p400, 0x1p400}, {});
  EXPECT_NO_THROW(surface_of(box, 12));
  box.vertices[0].x = 1e-300;
  EXPECT_THROW(surface_of(box, 12), LatticeOutOfRange);
}

}  // namespace
}  // namespace raycone
