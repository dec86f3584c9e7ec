#include "core/far/far_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/boundary/caps.h"
#include "core/evaluation/winding_number.h"
#include "core/mesh/weld.h"
#include "tests/support/diagnosed.h"
#include "tests/support/differences.h"
#include "tests/support/direct_winding_number.h"
#include "tests/support/lattice_samples.h"
#include "tests/support/shapes.h"
#include "tests/support/values.h"

namespace raycone {
namespace {

constexpr double kTolerances[] = {1e-4, 1e-7, 1e-10};

WindingNumberEvaluator evaluator_of(const TriangleMesh& mesh, double tolerance, SimdLevel level = SimdLevel::kBest) {
  return WindingNumberEvaluator(mesh,
                                {.level = level, .summation = Summation::kFarField, .accuracy = {tolerance, 1e6}});
}

// A sphere with many holes, large and small.
TriangleMesh sphere_with_holes(test::Random& random, int rings) {
  TriangleMesh mesh = test::sphere(rings);
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    const Vec3& v = mesh.vertices[t[0]];
    return v.z > 0.8 || test::uniform(random, 0, 1) < 0.05;
  });
  return mesh;
}

std::vector<TriangleMesh> open_meshes() {
  test::Random random(1);
  return {test::loosened(test::sphere(16), random, 0.01), sphere_with_holes(random, 40)};
}

std::vector<Vec3> some_points(std::size_t count) {
  test::Random random(2);
  std::vector<Vec3> points;
  while (points.size() < count) points.push_back(test::uniform_point(random, {{-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}}));
  return points;
}

TEST(FarField, KeepsTheTolerance) {
  const std::vector<Vec3> points = some_points(100);
  for (const TriangleMesh& mesh : open_meshes()) {
    for (const double tolerance : kTolerances) {
      const WindingNumberEvaluator evaluator = evaluator_of(mesh, tolerance);
      const std::vector<double> values = test::values_of(evaluator, points);
      EXPECT_GT(evaluator.terms().far, points.size());  // or this would be about nothing
      double largest = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        largest = test::larger_difference(largest, std::abs(values[i] - test::direct_winding_number(mesh, points[i])));
      }
      EXPECT_LE(largest, tolerance);
      EXPECT_GT(largest, 1e-15);
      EXPECT_LE(tolerance, evaluator.expected_error());
    }
  }
}

// Lattices, points, slabs and SIMD levels.
TEST(FarField, GivesAQueryTheSameBitsAnywhere) {
  Lattice lattice;
  lattice.spacing = {0.25, 0.25, 0.25};
  lattice.index_min = {-5, -5, -6};
  lattice.counts = {11, 10, 13};
  const std::vector<Vec3> points = test::samples_of(lattice);
  for (const TriangleMesh& mesh : open_meshes()) {
    const std::vector<double> expected = test::values_of(evaluator_of(mesh, 1e-7), points);
    for (const SimdLevel level : {SimdLevel::kBest, SimdLevel::kSse4, SimdLevel::kAvx2}) {
      if (!is_available(level) && level != SimdLevel::kBest) continue;
      const WindingNumberEvaluator evaluator = evaluator_of(mesh, 1e-7, level);
      const std::vector<double> values = test::values_of(evaluator, lattice);
      EXPECT_EQ(values, expected);
      const LatticeBlock slab{{-3, -5, 2}, {7, 10, 1}};
      std::vector<double> part(static_cast<std::size_t>(slab.size()));
      evaluator.evaluate(lattice, slab, part);
      for (std::size_t n = 0; n < part.size(); ++n) EXPECT_EQ(part[n], expected[(8 * 10 + n / 7) * 11 + 2 + n % 7]);
    }
  }
}

TEST(FarField, BoundsHoldForItsValues) {
  const std::vector<Vec3> points = some_points(20);
  for (const TriangleMesh& mesh : open_meshes()) {
    const WindingNumberEvaluator evaluator = evaluator_of(mesh, 1e-4);
    const test::Diagnosed found = test::diagnosed(evaluator, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double error = std::abs(found.values[i] - test::direct_winding_number(mesh, points[i]));
      EXPECT_LE(error, found.bounds[i] + 1e-14);  // the oracle's
      EXPECT_LE(found.bounds[i], 1e-4);
    }
  }
}

// On either side of a half-integer as without a far field, however rough it is.
TEST(FarField, DoesNotMoveValuesAcrossHalfIntegers) {
  test::Random random(3);
  for (const TriangleMesh& mesh : open_meshes()) {
    const WindingNumberEvaluator rough = evaluator_of(mesh, 1e-2), direct = evaluator_of(mesh, 0);
    // Points next to the isosurface, by bisection.
    std::vector<Vec3> points;
    for (int n = 0; n < 40; ++n) {
      Vec3 in{0, 0, 0}, out = test::uniform_point(random, {{-3, -3, 2}, {3, 3, 3}});
      for (int step = 0; step < 40; ++step) {
        const Vec3 middle = 0.5 * (in + out);
        (test::values_of(direct, {&middle, 1})[0] >= 0.5 ? in : out) = middle;
        points.push_back(middle);
      }
    }
    const std::vector<double> expected = test::values_of(direct, points), values = test::values_of(rough, points);
    EXPECT_GT(test::largest_difference(expected, values), 1e-9);
    for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(values[i] >= 0.5, expected[i] >= 0.5);
  }
}

// w is 1/2 in the plane of a flat opening: no far field is taken there, or all samples would tie with its caps.
TEST(FarField, HalfIntegersOfAWholeRegionStay) {
  TriangleMesh mesh = test::sphere(40);
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    const auto z = [&](std::size_t i) { return mesh.vertices[t[i]].z; };
    return std::min({z(0), z(1), z(2)}) > 0.1;
  });
  const double rim = [&] {
    double top = -1;
    for (const Triangle& t : mesh.triangles)
      for (const std::uint32_t v : t) top = std::max(top, mesh.vertices[v].z);
    return top;
  }();
  std::vector<Vec3> points;
  for (int i = -20; i < 20; ++i) points.push_back({0.04 * i, 0.01 * i, rim});
  EXPECT_EQ(test::values_of(evaluator_of(mesh, 1e-4), points), test::values_of(evaluator_of(mesh, 0), points));
}

TEST(FarField, ATinyToleranceIsNone) {
  const std::vector<Vec3> points = some_points(50);
  const TriangleMesh mesh = open_meshes()[0];
  const WindingNumberEvaluator tiny = evaluator_of(mesh, 9e-13);
  EXPECT_EQ(test::values_of(tiny, points), test::values_of(evaluator_of(mesh, 0), points));
  EXPECT_EQ(tiny.terms().far, 0U);
}

TEST(FarField, IsTakenWhereItPays) {
  const auto takes = [](const TriangleMesh& mesh, double tolerance, double samples) {
    const WindingNumberEvaluator evaluator(mesh, {.accuracy = {tolerance, samples}});
    (void)test::values_of(evaluator, some_points(10));
    return evaluator.terms().far > 0;
  };
  TriangleMesh many = test::sphere(60);  // a hole in each of many places
  std::erase_if(many.triangles, [](const Triangle& t) { return (t[0] * 7 + t[1] + t[2]) % 3 == 0; });
  EXPECT_TRUE(takes(many, 1e-4, 1e6));
  EXPECT_FALSE(takes(many, 1e-4, 1e5)) << "the tree takes longer than it spares";
  EXPECT_FALSE(takes(test::open_box(), 1e-4, 1e9)) << "few edges";
}

// A narrow ribbon that winds up costs its own area, not that of the cylinder it winds about; a round hole is halved.
TEST(FarField, CapsAreSmall) {
  TriangleMesh ribbon;
  constexpr std::uint32_t kSteps = 500;
  for (std::uint32_t i = 0; i <= kSteps; ++i) {
    const double angle = 0.1 * i;
    for (const double z : {0.0, 0.001}) ribbon.vertices.push_back({std::cos(angle), std::sin(angle), 0.002 * i + z});
    if (i == 0) continue;
    const std::uint32_t n = 2 * i;
    ribbon.triangles.push_back({n - 2, n, n - 1});
    ribbon.triangles.push_back({n - 1, n, n + 1});
  }
  const TriangleMesh caps = make_caps(Boundary(weld(ribbon, {})), 0.0).mesh;
  EXPECT_EQ(caps.triangles.size(), 2 * kSteps);
  EXPECT_LT(total_area(caps), 1.01 * total_area(ribbon));
}

}  // namespace
}  // namespace raycone
