#include "core/orientation/surface_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/machine/floating_point.h"
#include "core/orientation/canonical_face.h"
#include "core/orientation/surface_samples.h"
#include "tests/support/direct_winding_number.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

TEST(SurfaceField, IsFiniteNextToTheCentreOfADipole) {
  const SurfaceDipole dipole{{0, 0, 0}, {0, 0.25, 0}, 0.0};
  for (const double y : {0.0, 1e-320, 1e-200, 1e-110, 1e-90, 1e-17}) {
    for (const Vec3& q : {Vec3{y, 0, 0}, Vec3{0, y, 0}}) EXPECT_TRUE(std::isfinite(dipole.at(q))) << y;
  }
}

// Of a sphere with a hole, one half has become a point.
TEST(SurfaceField, DependsOnNoOrderWhereVerticesHaveMet) {
  const DefaultFloatingPoint guard;
  test::Random random(29);
  TriangleMesh mesh = test::moved(test::sphere(10), {0.5, 0.5, 0.5}, {0.5, 0.5, 0.5});
  std::erase_if(mesh.triangles, [](const Triangle& t) { return std::ranges::count(t, 50U) > 0; });
  for (Vec3& p : mesh.vertices) {
    if (p.x < 0.45) p = {0.3, 0.6, 0.7};
  }
  std::vector<FieldPoint> points;
  for (int i = 0; i < 200; ++i) points.push_back({test::uniform_point(random, {{0, 0, 0}, {1, 1, 1}}), 0});
  const std::vector<double> expected = SurfaceField(mesh.triangles, mesh.vertices).winding_numbers(points);
  for (int i = 0; i < 20; ++i) {
    const TriangleMesh other = test::shuffled(mesh, random);
    ASSERT_EQ(SurfaceField(other.triangles, other.vertices).winding_numbers(points), expected) << i;
  }
}

TEST(SurfaceField, IsTheMeanOfBothSidesOnTheSurface) {
  const DefaultFloatingPoint guard;
  // Within the unit box; without its last faces it has a boundary.
  TriangleMesh bowl = test::moved(test::sphere(8), {0.5, 0.5, 0.5}, {0.5, 0.5, 0.5});
  bowl.triangles.resize(bowl.triangles.size() * 2 / 3);
  const std::vector<SurfaceSample> samples =
      sample_surface(bowl.triangles, NumberedVertices(bowl.vertices, bowl.vertices), 20);
  ASSERT_EQ(samples.size(), 20U);
  std::vector<FieldPoint> points;
  for (const SurfaceSample& sample : samples) points.push_back({sample.at, sample.side});
  const std::vector<double> w = SurfaceField(bowl.triangles, bowl.vertices).winding_numbers(points);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    TriangleMesh others = bowl;
    std::erase_if(others.triangles,
                  [&](const Triangle& t) { return (canonical_face(t, bowl.vertices) <=> samples[i].face) == 0; });
    ASSERT_EQ(others.triangles.size() + 1, bowl.triangles.size());
    // Roundings of the cone; the face itself, from its middle but for rounding, is half a turn to 1e-14.
    EXPECT_NEAR(w[i], test::direct_winding_number(others, samples[i].at), 1e-12);
  }
}

}  // namespace
}  // namespace raycone
