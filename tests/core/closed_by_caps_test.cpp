#include "core/filling/closed_by_caps.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/certificate/certificate.h"
#include "core/mesh/exterior_edges.h"
#include "tests/core/surface_cases.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::bitten_sphere;
using test::part_of_sphere;

TEST(ClosedByCaps, ClosesTheMesh) {
  for (const TriangleMesh& mesh :
       {test::open_box(), bitten_sphere(16, 0.45, 0.2, 2.0), test::notched_fan(), test::fan(5, 3)}) {
    const TriangleMesh closed = closed_by_caps(mesh, exterior_edges(mesh));
    EXPECT_TRUE(exterior_edges(closed).empty());
    EXPECT_EQ(closed.vertices, mesh.vertices);
    EXPECT_TRUE(std::equal(mesh.triangles.begin(), mesh.triangles.end(), closed.triangles.begin()));
  }
}

// Two bowls, one in the other, without the rim between: a strip closes that, of triangles as narrow as it is.
TEST(ClosedByCaps, ClosesRimsByStrips) {
  const auto below = [](const Vec3& p) { return p.z < 0.3; };
  const TriangleMesh outer = part_of_sphere(12, below);
  const TriangleMesh inner = test::moved(outer, {0.9, 0.9, 0.9}, {0, 0, 0.02});
  const TriangleMesh bowl = test::joined(outer, test::reversed(inner));
  const TriangleMesh closed = closed_by_caps(bowl, exterior_edges(bowl));
  EXPECT_TRUE(exterior_edges(closed).empty());
  EXPECT_TRUE(is_closed_and_embedded(closed));
  EXPECT_EQ(closed.triangles.size(), bowl.triangles.size() + 48);  // loops of 24 edges
  // Not where holes are apart.
  const TriangleMesh two = test::joined(outer, test::moved(outer, {1, 1, -1}, {0, 0, 3}));
  EXPECT_EQ(closed_by_caps(two, exterior_edges(two)).triangles.size(), two.triangles.size() + 44);
}

}  // namespace
}  // namespace raycone
