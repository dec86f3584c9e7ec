#include "core/arrangement/plane_triangulation.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "core/arrangement/effort.h"
#include "core/data/triangle_mesh.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using Number = ExactPoints::Number;

constexpr int kSize = 9;

TriangleMesh lattice_mesh() { return {{{0, 0, 0}, {kSize, kSize, 0}}, {{0, 1, 0}}}; }

double twice_area(const ExactPoints& points, const std::array<Number, 3>& t) {
  const Vec3 ab = points.rounded(t[1]) - points.rounded(t[0]), ac = points.rounded(t[2]) - points.rounded(t[0]);
  return ab.x * ac.y - ab.y * ac.x;
}

// Every triangle turns left, every edge is of two that name each other, and they cover the triangle around all.
void expect_is_triangulation(const PlaneTriangulation& triangulation, const ExactPoints& points) {
  const auto& faces = triangulation.faces();
  double area = 0.0;
  for (std::uint32_t face = 0; face < faces.size(); ++face) {
    std::array<Number, 3> corners{};
    for (std::size_t i = 0; i < 3; ++i) corners[i] = triangulation.point(faces[face].corners[i]);
    EXPECT_EQ(points.turn(2, corners[0], corners[1], corners[2]), 1);
    area += twice_area(points, corners);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t other = faces[face].beyond[i];
      if (other == PlaneTriangulation::kNone) continue;
      bool is_named = false;
      for (std::size_t j = 0; j < 3; ++j) {
        is_named = is_named || (faces[other].beyond[j] == face &&
                                faces[other].corners[(j + 1) % 3] == faces[face].corners[(i + 2) % 3] &&
                                faces[other].corners[(j + 2) % 3] == faces[face].corners[(i + 1) % 3]);
      }
      EXPECT_TRUE(is_named);
    }
  }
  EXPECT_EQ(area, twice_area(points, {triangulation.point(0), triangulation.point(1), triangulation.point(2)}));
}

bool has_edge(const PlaneTriangulation& triangulation, Number a, Number b) {
  for (const PlaneTriangulation::Face& face : triangulation.faces()) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (triangulation.point(face.corners[i]) == a && triangulation.point(face.corners[(i + 1) % 3]) == b) return true;
    }
  }
  return false;
}

// Points of a small lattice, so that most lie on lines with others, and on edges.
TEST(PlaneTriangulation, HasPointsAndSegmentsOfALattice) {
  test::Random random(1);
  for (int round = 0; round < 300; ++round) {
    ExactPoints points(lattice_mesh());
    Effort effort(1 << 20);
    PlaneTriangulation triangulation(points, 2, points.add_triangle_around(2), effort);
    std::vector<Number> inserted;
    for (int n = 0; n < 3 + round % 60; ++n) {
      const double x = std::floor(test::uniform(random, 0, kSize + 1)),
                   y = std::floor(test::uniform(random, 0, kSize + 1));
      inserted.push_back(points.add({x, y, 0}));
      ASSERT_TRUE(triangulation.insert(inserted.back()));
    }
    // Segments that cross no other one but at ends: those that do are left out.
    std::vector<std::pair<Number, Number>> segments;
    const auto crosses = [&](Number a, Number b, Number c, Number d) {
      return points.turn(2, a, b, c) * points.turn(2, a, b, d) < 0 &&
             points.turn(2, c, d, a) * points.turn(2, c, d, b) < 0;
    };
    for (int n = 0; n < 40; ++n) {
      const auto any = [&] { return inserted[static_cast<std::size_t>(random() % inserted.size())]; };
      const Number a = any(), b = any();
      bool is_free = a != b;
      for (const auto& [c, d] : segments) is_free = is_free && !crosses(a, b, c, d);
      if (is_free) segments.emplace_back(a, b);
    }
    for (const auto& [a, b] : segments) ASSERT_TRUE(triangulation.connect(a, b));
    triangulation.make_delaunay();
    expect_is_triangulation(triangulation, points);
    for (const auto& [a, b] : segments) {
      const auto chain = triangulation.connect(a, b);
      ASSERT_TRUE(chain);
      EXPECT_EQ(chain->front(), a);
      EXPECT_EQ(chain->back(), b);
      for (std::size_t i = 1; i < chain->size(); ++i) {
        EXPECT_TRUE(has_edge(triangulation, (*chain)[i - 1], (*chain)[i]));
        EXPECT_EQ(points.turn(2, a, b, (*chain)[i]), 0);
      }
    }
    const auto size = triangulation.faces().size();
    EXPECT_EQ(size, 2 * std::set<Number>(inserted.begin(), inserted.end()).size() + 1);
  }
}

TEST(PlaneTriangulation, EndsWhereItsEffortDoes) {
  ExactPoints points(lattice_mesh());
  Effort effort(3);
  PlaneTriangulation triangulation(points, 2, points.add_triangle_around(2), effort);
  int inserted = 0;
  for (double x = 0; x < 10; x += 1) inserted += triangulation.insert(points.add({x, 0, 0})) ? 1 : 0;
  EXPECT_LT(inserted, 4);
}

}  // namespace
}  // namespace raycone
