// Surfaces with fewer triangles, and surfaces of sets that have grown.
#include "core/surface/simplify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/distance/distance.h"
#include "core/mesh/weld.h"
#include "core/surface/star_change.h"
#include "core/surface/surface.h"
#include "core/surface/thicken.h"
#include "tests/support/shapes.h"

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
  std::vector<double> distances(points.size());
  DistanceEvaluator(to).evaluate(points, distances);
  return *std::ranges::max_element(distances);
}

TEST(SimplifiedSurface, IsWithinTheDistanceBothWaysWithAllNodesOnTheirSides) {
  const TriangleMesh mesh = weld(test::sphere(8), {});
  const WindingNumberEvaluator evaluator(mesh);
  const NodeSet inside = nodes_inside(evaluator, {}, lattice_around_sphere(14));
  SurfaceOptions options;
  const SurfaceMesh whole_surface = closed_surface(mesh, evaluator, inside, options).surface;
  std::size_t before = whole_surface.mesh.triangles.size();
  for (const double most : {0.005, 0.02, 0.1}) {
    options.simplify = most;
    const SurfaceMesh surface = closed_surface(mesh, evaluator, inside, options).surface;
    EXPECT_LT(surface.mesh.triangles.size(), before);
    before = surface.mesh.triangles.size();
    EXPECT_TRUE(faults_of(surface.mesh, inside).none());
    EXPECT_LE(farthest(surface.mesh, whole_surface.mesh), most);
    EXPECT_LE(farthest(whole_surface.mesh, surface.mesh), most);
  }
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
  for (std::size_t target = 0; target < ring.size(); ++target) {
    const std::optional<double> distance = pulled({0, 0, 0}, ring, target).distance(1.0);
    EXPECT_LT(distance.value_or(0.0), 1e-12);
  }
}

// Merging moves points by up to 18.5 margins, which used to be taken for 16.
TEST(SimplifiedSurface, LeavesWhatMergingMayMove) {
  const TriangleMesh mesh = test::sphere(8);
  const WindingNumberEvaluator evaluator(mesh);
  const Lattice lattice{{-1.25, -1.25, -1.25}, {0.125, 0.125, 0.125}, {0, 0, 0}, {21, 21, 21}};
  const NodeSet inside = nodes_inside(evaluator, {}, lattice);
  const double margin = surface_margin(lattice, false) * lattice.spacing.x;
  for (const double margins : {17.0, 18.4, 18.6}) {
    SurfaceOptions options;
    options.simplify = margins * margin;
    EXPECT_EQ(closed_surface(mesh, evaluator, inside, options).bound_too_small, margins < 18.5) << margins;
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
  const TriangleMesh mesh = weld(test::open_box(), {});
  const WindingNumberEvaluator evaluator(mesh);
  const DistanceEvaluator distance(mesh);
  const Lattice lattice{{-0.5, -0.5, -0.5}, {0.1, 0.1, 0.1}, {0, 0, 0}, {21, 21, 21}};
  NodeSet inside = nodes_inside(evaluator, {}, lattice);
  SurfaceOptions options;
  options.thickness = 0.17;
  insert_near(inside, distance, options.thickness);
  const SurfaceMesh surface = closed_surface(mesh, evaluator, inside, options).surface;
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
