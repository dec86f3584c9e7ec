#include "core/orientation/surface_samples.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/machine/floating_point.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

// Two sheets that face each other have become one.
TEST(SurfaceSamples, TellFacesApartByWhereTheyWere) {
  const DefaultFloatingPoint guard;
  test::Random random(31);
  TriangleMesh sheets = test::soup(random, 40);
  for (Vec3& p : sheets.vertices) p.z = 0;
  sheets = test::joined(sheets, test::moved(test::reversed(sheets), {1, 1, 1}, {0, 0, 1}));
  const auto sides = [](const TriangleMesh& exact) {
    std::vector<Vec3> moved = exact.vertices;
    for (Vec3& p : moved) p.z = 0;
    std::vector<int> result;
    const NumberedVertices vertices(moved, exact.vertices);
    for (const SurfaceSample& sample : sample_surface(exact.triangles, vertices, 15)) result.push_back(sample.side);
    return result;
  };
  for (int i = 0; i < 10; ++i) EXPECT_EQ(sides(test::shuffled(sheets, random)), sides(sheets));
}

}  // namespace
}  // namespace raycone
