// What rays of points cross is found by passes over the triangles, by a grid, or by Embree: the same in each way.
#include "core/evaluation/point_crossings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "core/evaluation/points.h"
#include "core/evaluation/winding_number.h"
#include "core/machine/floating_point.h"
#include "core/machine/threads.h"
#include "tests/support/diagnosed.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::Diagnosed;
using test::diagnosed;

// In and about the unit cubes of a mesh of cells, on a lattice through its corners, and some that are far away or too
// small to be scaled.
std::vector<Vec3> points_about_cells(test::Random& random, std::size_t count) {
  constexpr double kFar[] = {1e300, -1e300, 1e17, 5e-324, -1e-310, 1e-300};
  std::vector<Vec3> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    points[i] = test::uniform_point(random, {{-1, -1, -1}, {4, 4, 4}});
    if (i % 3 == 0) points[i] = {0.5 * double(random() % 8), 0.5 * double(random() % 8), 0.5 * double(random() % 8)};
    if (i % 50 == 0) points[i][static_cast<int>(random() % 3)] = kFar[random() % 6];
  }
  return points;
}

TEST(PointCrossings, AreTheSameByPassesAndByGrid) {
  test::Random random(1);
  const std::vector<Vec3> points = points_about_cells(random, 6000);
  const TriangleMesh soup = test::moved(test::soup(random, 200), {3, 3, 3}, {0, 0, 0});
  for (const TriangleMesh& mesh : {test::random_cells(random, 3), test::lattice_soup(random, 30, 3), soup}) {
    const WindingNumberEvaluator by_passes(mesh, {.ray_engine = RayEngine::kPasses}), by_grid(mesh);
    by_grid.prepare_points();
    const Diagnosed expected = diagnosed(by_grid, points);
    EXPECT_GT(std::ranges::count_if(expected.crossings, [](std::int64_t n) { return n != 0; }), 500);
    EXPECT_TRUE(diagnosed(by_passes, points) == expected);
    EXPECT_TRUE(diagnosed(WindingNumberEvaluator(mesh, {.ray_engine = RayEngine::kEmbree}), points) == expected);
    for (const int threads : {1, 3, 16}) {
      const ThreadLimit limit(threads);
      EXPECT_TRUE(diagnosed(by_passes, points) == expected) << threads;
    }
  }
}

// Of a mesh that takes a grid for so many points, those that cannot be scaled come by themselves: of the small one by a
// grid, too, of the large one in two passes.
TEST(PointCrossings, AreTheSameForManyPointsThatCannotBeScaled) {
  test::Random random(2);
  std::vector<Vec3> points = points_about_cells(random, 200'000);
  for (std::size_t i = 0; i < points.size(); i += 3) points[i][static_cast<int>(random() % 3)] = 5e-324;
  const TriangleMesh large = test::moved(test::sphere(160), {2, 2, 2}, {1, 1, 1});
  for (const TriangleMesh& mesh : {test::random_cells(random, 3), large}) {
    const WindingNumberEvaluator any(mesh), by_passes(mesh, {.ray_engine = RayEngine::kPasses});
    EXPECT_TRUE(grid_pays_for_points(static_cast<double>(points.size()), double(mesh.triangles.size())));
    EXPECT_TRUE(diagnosed(any, points) == diagnosed(by_passes, points));
  }
  EXPECT_FALSE(grid_pays_for_points(static_cast<double>(points.size()) / 3, double(large.triangles.size())));
}

// Needles whose boxes are large: each of them may meet a quarter of all rays.
TriangleMesh needles(test::Random& random, std::uint32_t count) {
  TriangleMesh mesh;
  for (std::uint32_t n = 0; n < count; ++n) {
    const Vec3 from = test::uniform_point(random, {{0, 0, 0}, {1, 0.2, 0.2}});
    const Vec3 to = test::uniform_point(random, {{0, 0.8, 0.8}, {1, 1, 1}});
    mesh.vertices.insert(mesh.vertices.end(), {from, to, to + Vec3{0.01, 0.01, -0.01}});
    mesh.triangles.push_back({3 * n, 3 * n + 1, 3 * n + 2});
  }
  return mesh;
}

TEST(PointCrossings, AreFoundByAGridWhereTrianglesMeetTooManyRays) {
  const DefaultFloatingPoint guard;
  test::Random random(3);
  std::vector<NumberedRay> rays(3000);
  std::vector<Vec3> points;
  for (std::uint32_t n = 0; n < rays.size(); ++n) {
    rays[n] = {test::uniform_point(random, {{0, 0, 0}, {1, 1, 1}}), n};
    points.push_back(rays[n].origin);
  }
  const auto meets_too_many = [&](const TriangleMesh& mesh) {
    const ScaledMeshes meshes(mesh, {});
    const ScaledMesh& scaled = meshes.scaled();
    EXPECT_TRUE(takes_passes(scaled));
    std::vector<NumberedRay> in_scale = rays;
    for (NumberedRay& ray : in_scale) ray.origin = scaled.to_scale(ray.origin);
    const bool gives_up = !crossings_by_pass(scaled, in_scale, rays.size());
    EXPECT_EQ(takes_passes(scaled), !gives_up);
    const WindingNumberEvaluator by_passes(mesh, {.ray_engine = RayEngine::kPasses});
    EXPECT_TRUE(diagnosed(WindingNumberEvaluator(mesh), points) == diagnosed(by_passes, points));
    return gives_up;
  };
  EXPECT_TRUE(meets_too_many(needles(random, 4000)));
  EXPECT_FALSE(meets_too_many(test::sphere(45)));  // as many triangles
}

// Points in portions, as questions in a pipe come: passes are given up in the midst of them, sooner or later.
TEST(PointCrossings, AreTheSameInPortions) {
  test::Random random(4);
  const TriangleMesh mesh = needles(random, 4000), open = test::joined(needles(random, 3000), test::sphere(30));
  std::vector<Vec3> points(6000);
  for (Vec3& p : points) p = test::uniform_point(random, {{-0.2, -0.2, -0.2}, {1, 1, 1}});
  for (std::size_t i = 0; i < points.size(); i += 11) points[i].x = 5e-324;
  for (const TriangleMesh& each : {mesh, open}) {
    std::vector<double> expected(points.size()), values(points.size());
    WindingNumberEvaluator(each, {.ray_engine = RayEngine::kPasses}).evaluate(points, expected);
    for (const std::size_t portion : {1U, 17U, 700U, 5000U}) {
      const WindingNumberEvaluator evaluator(each);
      evaluator.prepare_points(static_cast<double>(points.size()));
      const std::size_t end = std::min<std::size_t>(points.size(), 300 * portion);
      for (std::size_t i = 0; i < end; i += portion) {
        const std::size_t count = std::min(portion, end - i);
        evaluator.evaluate(std::span(points).subspan(i, count), std::span(values).subspan(i, count));
      }
      EXPECT_TRUE(std::equal(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(end), expected.begin()))
          << portion;
    }
  }
}

// Each meets 60 spheres' triangles: what the first points take tells that the grid pays, though it seldom does so
// early.
TEST(PointCrossings, OfAFewTellWhetherAGridPays) {
  const DefaultFloatingPoint guard;
  test::Random random(5);
  const TriangleMesh one = test::sphere(20);
  TriangleMesh nested = one;
  for (int n = 1; n < 60; ++n) {
    const double size = 1.0 - n / 100.0;
    nested = test::joined(nested, test::moved(one, {size, size, size}, {0, 0, 0}));
  }
  std::vector<Vec3> points(80'000);
  for (Vec3& p : points) p = test::uniform_point(random, {{-0.2, -0.2, -0.2}, {0.2, 0.2, 0.2}});
  const auto takes_grid = [&](const TriangleMesh& mesh) {
    const ScaledMeshes meshes(mesh, {});
    const ScaledMesh& scaled = meshes.scaled();
    EXPECT_FALSE(grid_pays_for_points(static_cast<double>(points.size()), double(mesh.triangles.size())));
    EXPECT_LT(scaled.grid_choice().points_to_try(points.size()), points.size());
    std::vector<double> values(points.size());
    evaluate_points(meshes, points, {values});
    EXPECT_EQ(scaled.grid_choice().points_to_try(points.size()), points.size());  // once is enough
    return scaled.grid_if_built() != nullptr;
  };
  EXPECT_TRUE(takes_grid(nested));
  EXPECT_FALSE(takes_grid(test::sphere(170)));
}

// A rule of thumb may be off by a factor, not by ten.
TEST(PointCrossings, TakeAGridForManyPointsOfASmallMesh) {
  EXPECT_FALSE(grid_pays_for_points(1, 12));
  EXPECT_FALSE(grid_pays_for_points(1000, 10'000));
  EXPECT_FALSE(grid_pays_for_points(1e5, 1e6));
  EXPECT_TRUE(grid_pays_for_points(1000, 12));
  EXPECT_TRUE(grid_pays_for_points(1e5, 10'000));
  EXPECT_TRUE(grid_pays_for_points(1e7, 1e6));
  EXPECT_TRUE(grid_pays_for_points(std::numeric_limits<double>::infinity(), 1e9));
}

}  // namespace
}  // namespace raycone
