// Surfaces with fewer triangles, and surfaces of sets that have grown.
#include "core/merging/simplify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/cells/plane_tolerance.h"
#include "core/cells/source_plane.h"
#include "core/cells/surface_mesh.h"
#include "core/certificate/certificate.h"
#include "core/certificate/component_signs.h"
#include "core/data/coordinate_precision.h"
#include "core/distance/distance.h"
#include "core/merging/checked_simplify.h"
#include "core/merging/star_change.h"
#include "core/mesh/used_part.h"
#include "core/surface/surface.h"
#include "core/surface/thicken.h"
#include "tests/support/shapes.h"
#include "tests/support/values.h"

namespace raycone {
namespace {

using test::Random;
using test::uniform;

Lattice lattice_around_sphere(std::int64_t side) {
  const double h = 3.0 / static_cast<double>(side - 1);
  return {{-1.49, -1.51, -1.5}, {h, h, h}, {0, 0, 0}, {side, side, side}};
}

// Vertices, and places within triangles.
double farthest(const TriangleMesh& of, const TriangleMesh& to) {
  std::vector<Vec3> points = of.vertices;
  for (const Triangle& t : of.triangles) {
    const Vec3 &a = of.vertices[t[0]], &b = of.vertices[t[1]], &c = of.vertices[t[2]];
    for (const Vec3& weights : {Vec3{1, 1, 1}, Vec3{1, 1, 0}, Vec3{0, 1, 1}, Vec3{1, 0, 1}}) {
      const double sum = weights.x + weights.y + weights.z;
      points.push_back(1.0 / sum * (weights.x * a + weights.y * b + weights.z * c));
    }
  }
  const std::vector<double> distances = test::values_of(DistanceEvaluator(to), points);
  return *std::ranges::max_element(distances);
}

TEST(SimplifiedSurface, IsWithinTheDistanceBothWaysWithAllNodesOnTheirSides) {
  const TriangleMesh mesh = test::sphere(16);
  const WindingNumberEvaluator evaluator(mesh);
  const NodeSet inside = nodes_inside(evaluator, {}, lattice_around_sphere(14));
  SurfaceOptions options;
  const SurfaceMesh whole_surface = closed_surface({mesh, evaluator, inside, options}).surface;
  std::size_t before = whole_surface.mesh.triangles.size();
  for (const double most : {0.005, 0.02, 0.1}) {
    options.simplify = most;
    const SurfaceMesh surface = closed_surface({mesh, evaluator, inside, options}).surface;
    EXPECT_LT(surface.mesh.triangles.size(), before);
    before = surface.mesh.triangles.size();
    EXPECT_TRUE(faults_of(surface.mesh, inside).none());
    EXPECT_LE(farthest(surface.mesh, whole_surface.mesh), most);
    EXPECT_LE(farthest(whole_surface.mesh, surface.mesh), most);
  }
}

// Bodies between the nodes that are thinner than the distance, which could make them flat, or turn them over.
TEST(SimplifiedSurface, LeavesThinPartsAVolume) {
  Random random(7);
  const TriangleMesh ball = test::sphere(8);
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(ball), {}, lattice_around_sphere(14));
  int turned = 0;
  for (int round = 0; round < 60; ++round) {
    TriangleMesh thin = test::sphere(3 + round % 3);
    for (Vec3& v : thin.vertices) v = {0.1 * v.x, 0.1 * v.y, 1.36 + 0.003 * v.z + uniform(random, -0.002, 0.002)};
    SurfaceMesh surface{test::joined(ball, thin), {}};
    surface.sources.assign(surface.mesh.triangles.size(), 0);
    if (!is_closed_and_embedded(surface.mesh)) continue;
    const std::vector<bool> none(surface.mesh.vertices.size(), false);
    MergedFaces unchecked = simplify(surface, inside, none, 0.05);
    turned += component_signs(used_part(surface.mesh.vertices, unchecked.triangles)).of_component != std::vector{1, 1};
    ASSERT_TRUE(checked_simplify(surface, inside, 0.05, 16));
    EXPECT_EQ(component_signs(surface.mesh).of_component, (std::vector{1, 1})) << round;
  }
  EXPECT_GT(turned, 0);  // else nothing has been tried
}

// A fan of random faces around a vertex, about flat.
std::vector<Vec3> random_ring(Random& random, double height) {
  std::vector<Vec3> ring;
  for (int n = 0; n < 6; ++n) {
    const double angle = n + uniform(random, 0.0, 0.5), radius = uniform(random, 0.5, 1.5);
    ring.push_back({radius * std::cos(angle), radius * std::sin(angle), uniform(random, -height, height)});
  }
  return ring;
}

TriangleMesh fan_of(const Vec3& apex, const std::vector<Vec3>& ring) {
  TriangleMesh mesh{{apex}, {}};
  const auto size = static_cast<std::uint32_t>(ring.size());
  for (std::uint32_t n = 0; n < size; ++n) {
    mesh.vertices.push_back(ring[n]);
    if (!(apex == ring[n]) && !(apex == ring[(n + 1) % size])) mesh.triangles.push_back({0, n + 1, (n + 1) % size + 1});
  }
  return mesh;
}

// Of a neighbour of the vertex.
StarChange pulled(const Vec3& vertex, const std::vector<Vec3>& ring, std::size_t target) {
  StarChange change(vertex, ring);
  change.pull_into(target);
  return change;
}

TEST(StarChange, NoPointIsFartherThanItSays) {
  Random random(3);
  int compared = 0;
  for (int n = 0; n < 500; ++n) {
    const std::vector<Vec3> ring = random_ring(random, 0.3);
    const Vec3 vertex{0, 0, uniform(random, -0.3, 0.3)};
    const auto target = static_cast<std::size_t>(n % 6);
    const std::optional<double> distance = pulled(vertex, ring, target).distance(10.0);
    if (!distance) continue;
    ++compared;
    const TriangleMesh before = fan_of(vertex, ring), after = fan_of(ring[target], ring);
    // Rounding alone may add to it.
    EXPECT_LE(farthest(before, after), *distance + 1e-12) << n;
    EXPECT_LE(farthest(after, before), *distance + 1e-12) << n;
  }
  EXPECT_GT(compared, 100);
}

TEST(StarChange, OfFacesInOnePlaneIsNothing) {
  Random random(4);
  const std::vector<Vec3> ring = random_ring(random, 0.0);
  int known = 0;
  for (std::size_t target = 0; target < ring.size(); ++target) {
    const std::optional<double> distance = pulled({0, 0, 0}, ring, target).distance(1.0);
    EXPECT_LT(distance.value_or(0.0), 1e-12);
    known += distance ? 1 : 0;
  }
  EXPECT_GT(known, 0);
}

// Merging moves points by up to 21 margins.
TEST(SimplifiedSurface, LeavesWhatMergingMayMove) {
  const TriangleMesh mesh = test::sphere(8);
  const WindingNumberEvaluator evaluator(mesh);
  const Lattice lattice{{-1.25, -1.25, -1.25}, {0.125, 0.125, 0.125}, {0, 0, 0}, {21, 21, 21}};
  const NodeSet inside = nodes_inside(evaluator, {}, lattice);
  const double margin = surface_margin(lattice, CoordinatePrecision::kDouble) * lattice.spacing.x;
  for (const double margins : {17.0, 20.9, 21.1}) {
    SurfaceOptions options;
    options.simplify = margins * margin;
    EXPECT_EQ(closed_surface({mesh, evaluator, inside, options}).bound_too_small, margins < 21.0) << margins;
  }
}

// What is left of a merged or simplified surface, both ways, of a mesh whose coordinates are rounded by a thousandth of
// a voxel and more.
struct Moved {
  double tolerance;
  double farthest;
};
Moved moved_by(const TriangleMesh& mesh, double simplify) {
  const Box box = bounding_box(mesh);
  Lattice lattice{{}, {1, 1, 1}, {-2, -2, -2}, {}};
  for (int axis = 0; axis < 3; ++axis) {
    lattice.origin[axis] = std::floor(box.lower[axis]);
    lattice.counts[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(box.upper[axis] - box.lower[axis]) + 6;
  }
  const WindingNumberEvaluator evaluator(mesh);
  const NodeSet inside = nodes_inside(evaluator, {}, lattice);
  SurfaceOptions options;
  options.merge_planes = false;
  const TriangleMesh all = closed_surface({mesh, evaluator, inside, options}).surface.mesh;
  options.merge_planes = true;
  options.simplify = simplify;
  const FinishedSurface fewer = closed_surface({mesh, evaluator, inside, options});
  EXPECT_TRUE(fewer.merged && fewer.simplified);
  EXPECT_LT(fewer.surface.mesh.triangles.size(), all.triangles.size() * 3 / 4);
  return {plane_tolerance(mesh, lattice),
          std::max(farthest(all, fewer.surface.mesh), farthest(fewer.surface.mesh, all))};
}

TriangleMesh rounded_to_floats(TriangleMesh mesh) {
  round_to(CoordinatePrecision::kSingle, mesh.vertices);
  return mesh;
}

// Far behind its ridge, a point is within the tolerance of both planes of a blade.
TEST(MergedSurface, KeepsTheRidgeOfABlade) {
  const TriangleMesh blade =
      rounded_to_floats({{{8192.3, 8192.2, 8192},
                          {8201.3, 8222.2, 8192},
                          {8249.77, 8174.96, 8192.06},
                          {8258.77, 8204.96, 8192.06},
                          {8249.77, 8174.96, 8191.94},
                          {8258.77, 8204.96, 8191.94}},
                         {{0, 2, 3}, {0, 3, 1}, {0, 5, 4}, {0, 1, 5}, {2, 4, 5}, {2, 5, 3}, {0, 4, 2}, {1, 3, 5}}});
  const Moved moved = moved_by(blade, 0.0);
  EXPECT_LE(moved.farthest, 2 * moved.tolerance);
}

// Points that vanish may be off a plane on one side, and corners that are left on the other.
TEST(SimplifiedSurface, IsWithinTheDistanceWhereCoordinatesAreRounded) {
  constexpr int kSide = 40;
  Random random(5);
  TriangleMesh mesh{{}, {}};
  const auto number = [](int i, int j) { return static_cast<std::uint32_t>(i * (kSide + 1) + j); };
  for (int i = 0; i <= kSide; ++i) {
    for (int j = 0; j <= kSide; ++j)
      mesh.vertices.push_back({8192.2 + 0.4 * i, 8192.3 + 0.4 * j, 8202.37 + uniform(random, -0.001, 0.001)});
  }
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      mesh.triangles.push_back({number(i, j), number(i + 1, j), number(i + 1, j + 1)});
      mesh.triangles.push_back({number(i, j), number(i + 1, j + 1), number(i, j + 1)});
    }
  }
  // Closed by a cone of its border.
  const auto apex = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.push_back({8200.2, 8200.3, 8190});
  const auto close = [&](std::uint32_t from, std::uint32_t to) { mesh.triangles.push_back({to, from, apex}); };
  for (int n = 0; n < kSide; ++n) {
    close(number(n, 0), number(n + 1, 0));
    close(number(kSide, n), number(kSide, n + 1));
    close(number(n + 1, kSide), number(n, kSide));
    close(number(0, n + 1), number(0, n));
  }
  mesh = rounded_to_floats(std::move(mesh));
  for (const double most : {0.0005, 0.001, 0.002}) EXPECT_LE(moved_by(mesh, most).farthest, most);
}

// What a pull may cost does not make it look at more nodes: faces are where they are.
TEST(SimplifiedSurface, TakesNoLongerForDistancesBeyondAllSizes) {
  const TriangleMesh mesh = test::open_box();
  const WindingNumberEvaluator evaluator(mesh);
  const NodeSet inside = nodes_inside(evaluator, {}, {{-0.3, -0.3, -0.3}, {0.2, 0.2, 0.2}, {0, 0, 0}, {9, 9, 9}});
  SurfaceOptions options;
  for (const double most : {10.0, 1e3, 1e6, 1e300}) {
    options.simplify = most;
    const FinishedSurface finished = closed_surface({mesh, evaluator, inside, options});
    EXPECT_TRUE(faults_of(finished.surface.mesh, inside).none()) << most;
  }
}

TEST(StarChange, SeesNodesBetween) {
  // A tip of height 0.5 over a square that becomes flat.
  const std::vector<Vec3> ring{{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  const StarChange change = pulled({0, 0, 0.5}, ring, 0);
  const std::optional<double> distance = change.distance(1.0);
  ASSERT_TRUE(distance);
  EXPECT_NEAR(*distance, 0.5, 1e-9);
  const auto passes = [&](double z) {
    return change.passes_node({{0.25, 0.25, z}, {9, 9, 9}, {-2, -2, -2}, {5, 5, 5}}, *distance);
  };
  // The tip's faces are 0.25 high there.
  EXPECT_TRUE(passes(0.2));
  EXPECT_TRUE(passes(0.01));
  EXPECT_FALSE(passes(0.3));
  EXPECT_FALSE(passes(-0.1));
}

TEST(ThickSurface, IsAtItsDistanceOrWhereTheRuleEnds) {
  const TriangleMesh mesh = test::open_box();
  const WindingNumberEvaluator evaluator(mesh);
  const DistanceEvaluator distance(mesh);
  const Lattice lattice{{-0.5, -0.5, -0.5}, {0.1, 0.1, 0.1}, {0, 0, 0}, {21, 21, 21}};
  NodeSet inside = nodes_inside(evaluator, {}, lattice);
  SurfaceOptions options;
  options.thickness = 0.17;
  insert_near(inside, distance, options.thickness);
  const SurfaceMesh surface = closed_surface({mesh, evaluator, inside, options}).surface;
  const std::vector<Vec3>& vertices = surface.mesh.vertices;
  std::vector<double> distances(vertices.size()), w(vertices.size());
  distance.evaluate(vertices, distances);
  evaluator.evaluate(vertices, w);
  int in_hole = 0;
  for (std::size_t n = 0; n < vertices.size(); ++n) {
    // Roots are good to 2^-34 of an edge, points keep off nodes by 2^-30.
    const bool at_distance = std::abs(distances[n] - options.thickness) < 1e-9;
    if (!at_distance) ++in_hole;
    EXPECT_TRUE(at_distance || (distances[n] > options.thickness && std::abs(w[n] - 0.5) < 1e-8)) << n;
  }
  EXPECT_GT(in_hole, 0);
}

}  // namespace
}  // namespace raycone
