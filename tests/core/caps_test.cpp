#include "core/boundary/caps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

#include "core/mesh/exterior_edges.h"
#include "core/mesh/weld.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

TEST(Caps, HaveTheBoundaryOfTheMesh) {
  test::Random random(5);
  for (int i = 0; i < 30; ++i) {
    const TriangleMesh mesh = weld(i % 2 ? test::lattice_soup(random, 40, 3) : test::soup(random, 20), {});
    for (const double width : {0.0, 0.3, 100.0}) {
      const Caps caps = make_caps(Boundary(mesh), width);
      EXPECT_TRUE(exterior_edges(weld(test::joined(mesh, test::reversed(caps.mesh)), {})).empty());
      const auto narrow = static_cast<std::ptrdiff_t>(caps.narrow);
      TriangleMesh wide = caps.mesh;
      wide.triangles.erase(wide.triangles.begin(), wide.triangles.begin() + narrow);
      // Edges that are there and back have vanished from the boundary of the caps.
      EXPECT_LE(exterior_edges(weld(wide, {})).size(), caps.wide_loops.size());
    }
  }
}

TEST(Caps, OfAStripTakeLittleMoreThanItsArea) {
  // A ribbon along a helix, of width 0.02: the loop is 2 * 400 edges long.
  TriangleMesh ribbon;
  for (int i = 0; i < 400; ++i) {
    const double angle = 0.05 * i;
    for (const double z : {0.0, 0.02}) ribbon.vertices.push_back({std::cos(angle), std::sin(angle), 0.01 * i + z});
    const auto v = static_cast<std::uint32_t>(2 * i);
    if (i > 0) ribbon.triangles.insert(ribbon.triangles.end(), {{v - 2, v, v - 1}, {v - 1, v, v + 1}});
  }
  const auto area = [](const TriangleMesh& mesh) {
    double sum = 0.0;
    for (const Triangle& t : mesh.triangles) {
      const Vec3& a = mesh.vertices[t[0]];
      const Vec3 n = cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a);
      sum += std::sqrt(dot(n, n)) / 2;
    }
    return sum;
  };
  EXPECT_LT(area(make_caps(Boundary(ribbon), 0.1).mesh), 1.1 * area(ribbon));
}

}  // namespace
}  // namespace raycone
