#include "core/boundary/caps.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "core/mesh/exterior_edges.h"
#include "core/mesh/weld.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using Ends = std::array<double, 6>;

Ends ends(const Vec3& a, const Vec3& b) { return {a.x, a.y, a.z, b.x, b.y, b.z}; }

// How often edges lead each way, less how often they lead back.
void add_edge(const Vec3& from, const Vec3& to, std::map<Ends, int>& chain) {
  for (const auto& [edge, times] : {std::pair(ends(from, to), 1), std::pair(ends(to, from), -1)}) {
    if ((chain[edge] += times) == 0) chain.erase(edge);
  }
}

TEST(Caps, HaveTheBoundaryOfTheMesh) {
  test::Random random(5);
  for (int i = 0; i < 30; ++i) {
    const TriangleMesh mesh = weld(i % 2 ? test::lattice_soup(random, 40, 3) : test::soup(random, 20), {});
    for (const double width : {0.0, 0.3, 100.0}) {
      const Caps caps = make_caps(Boundary(mesh), width);
      EXPECT_TRUE(exterior_edges(test::joined(mesh, test::reversed(caps.mesh))).empty());
      std::map<Ends, int> of_wide_caps, of_wide_loops;
      for (std::size_t n = caps.narrow; n < caps.mesh.triangles.size(); ++n) {
        const auto corner = [&](std::size_t at) { return caps.mesh.vertices[caps.mesh.triangles[n][at % 3]]; };
        for (std::size_t at = 0; at < 3; ++at) add_edge(corner(at), corner(at + 1), of_wide_caps);
      }
      for (const DirectedEdge& edge : caps.wide_loops) add_edge(edge.from, edge.to, of_wide_loops);
      EXPECT_EQ(of_wide_loops, of_wide_caps);
      EXPECT_TRUE(width == 0.3 || caps.wide_loops.empty() == (width == 100.0));
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
