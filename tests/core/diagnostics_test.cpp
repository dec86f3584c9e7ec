// The error bound holds, is useful, and the other diagnostics are what they say.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/evaluation/winding_number.h"
#include "core/machine/threads.h"
#include "core/mesh/weld.h"
#include "tests/support/diagnosed.h"
#include "tests/support/direct_winding_number.h"
#include "tests/support/shapes.h"
#include "tests/support/values.h"

namespace raycone {
namespace {

using test::Diagnosed;
using test::Random;

Diagnosed diagnosed_at(const TriangleMesh& mesh, const std::vector<Vec3>& queries) {
  return test::diagnosed(WindingNumberEvaluator(mesh), queries);
}

struct BoundQuality {
  std::uint64_t violations = 0;
  double median_ratio = 0.0;  // of the bound to the error, errors below one unit in the last place counted as that
  double largest_bound = 0.0;
};

BoundQuality quality_of_bounds(const TriangleMesh& mesh, const std::vector<Vec3>& queries) {
  const Diagnosed d = diagnosed_at(mesh, queries);
  std::vector<double> ratios(queries.size());
  std::vector<std::uint8_t> violated(queries.size());
  parallel_for(queries.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const __float128 exact = test::direct_winding_number_quad(mesh, queries[i]);
      const double error = static_cast<double>(exact > d.values[i] ? exact - d.values[i] : d.values[i] - exact);
      violated[i] = !(error <= d.bounds[i]);  // NaN violates
      ratios[i] = d.bounds[i] / std::max(error, std::abs(d.values[i]) * 0x1p-53);
    }
  });
  BoundQuality quality;
  quality.violations = static_cast<std::uint64_t>(std::count(violated.begin(), violated.end(), 1));
  std::nth_element(ratios.begin(), ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2), ratios.end());
  quality.median_ratio = ratios[ratios.size() / 2];
  quality.largest_bound = *std::max_element(d.bounds.begin(), d.bounds.end());
  return quality;
}

TEST(ErrorBound, HoldsAndIsTightOnSoups) {
  Random random(1);
  for (const int triangles : {1, 5, 30, 150}) {
    const TriangleMesh mesh = weld(test::soup(random, triangles), {});
    std::vector<Vec3> queries;
    for (int i = 0; i < 30000 / triangles; ++i)
      queries.push_back(test::uniform_point(random, {{-1, -1, -1}, {2, 2, 2}}));
    const BoundQuality quality = quality_of_bounds(mesh, queries);
    EXPECT_EQ(quality.violations, 0U);
    EXPECT_LT(quality.median_ratio, 20);
    EXPECT_LT(quality.largest_bound, 1e-13);
  }
}

TEST(ErrorBound, HoldsNearEdgesAndOnDegenerateRays) {
  Random random(2);
  const TriangleMesh mesh = test::joined(test::open_box(), weld(test::soup(random, 6), {}));
  std::vector<Vec3> queries;
  for (int i = 0; i < 3000; ++i) {
    const Triangle& t = mesh.triangles[random() % mesh.triangles.size()];
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]];
    const double along = test::uniform(random, 0, 1), distance = std::pow(10.0, -test::uniform(random, 1, 12));
    const Vec3 step{distance * test::uniform(random, -1, 1), distance * test::uniform(random, -1, 1), distance};
    queries.push_back(a + along * (b - a) + step);
    queries.push_back({test::uniform(random, -1, 2), a.y + distance, a.z});
    queries.push_back({test::uniform(random, -1, 2) + 1e-3, a.y, a.z});
  }
  const Diagnosed d = diagnosed_at(mesh, queries);
  std::vector<Vec3> off_surface;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    if (!d.on_surface[i]) off_surface.push_back(queries[i]);
  }
  ASSERT_GT(off_surface.size(), 5000U);
  const BoundQuality quality = quality_of_bounds(mesh, off_surface);
  EXPECT_EQ(quality.violations, 0U);
  EXPECT_LT(quality.largest_bound, 1e-12);
}

TEST(ErrorBound, AThousandthOfItWouldBeViolated) {  // negative control: the comparison above can fail
  Random random(3);
  const TriangleMesh mesh = weld(test::soup(random, 30), {});
  int violations = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 q = test::uniform_point(random, {{0, 0, 0}, {1, 1, 1}});
    const Diagnosed d = diagnosed_at(mesh, {q});
    const __float128 error = test::direct_winding_number_quad(mesh, q) - d.values[0];
    violations += (error < 0 ? -error : error) > d.bounds[0] / 1000;
  }
  EXPECT_GT(violations, 100);
}

TEST(ErrorBound, IsZeroForClosedMeshes) {
  const Diagnosed d = diagnosed_at(test::sphere(8), {{0, 0, 0}, {0.3, 0.2, 0.1}, {2, 0, 0}});
  EXPECT_EQ(d.bounds, (std::vector<double>{0, 0, 0}));
  EXPECT_EQ(d.crossings, (std::vector<std::int64_t>{1, 1, 0}));
}

TEST(Diagnostics, ChangeNoValueAndAddUpToTheTally) {
  Random random(4);
  const TriangleMesh mesh = test::joined(test::open_box(), test::lattice_soup(random, 12, 2));
  std::vector<Vec3> queries;
  for (int i = 0; i < 343; ++i) queries.push_back({i % 7 * 0.5 - 0.5, i / 7 % 7 * 0.5, i / 49 * 0.5});
  const Diagnosed d = diagnosed_at(mesh, queries);
  const std::vector<double> plain = test::values_of(WindingNumberEvaluator(mesh), queries);
  EXPECT_EQ(d.values, plain);
  std::uint64_t degenerate = 0, on_surface = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    degenerate += static_cast<std::uint64_t>(d.degenerate[i]);
    on_surface += d.on_surface[i];
  }
  EXPECT_EQ(degenerate, d.tally.degenerate);
  EXPECT_EQ(on_surface, d.tally.on_surface);
  EXPECT_GT(on_surface, 0U);
}

}  // namespace
}  // namespace raycone
