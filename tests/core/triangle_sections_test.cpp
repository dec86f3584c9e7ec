#include "core/crossings/triangle_sections.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "core/crossings/crossings.h"
#include "core/machine/floating_point.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

struct Counts {
  int concerned = 0, visited = 0, all = 0;
};

// Rows y, z from the lists within the box of the triangle: each that the triangle concerns is visited, and none twice.
void expect_visits(const Vec3& a, const Vec3& b, const Vec3& c, const std::vector<double>& list, int along,
                   Counts& counts) {
  const std::vector<double> xs{std::max({a.x, b.x, c.x}) - 1e-9};
  const int across = 3 - along;
  const auto within = [&](int axis) {
    const auto lower = std::lower_bound(list.begin(), list.end(), std::min({a[axis], b[axis], c[axis]}));
    const auto upper = std::upper_bound(list.begin(), list.end(), std::max({a[axis], b[axis], c[axis]}));
    return std::pair(lower - list.begin(), upper - list.begin());
  };
  const auto [begin, end] = within(along);
  const auto [first, last] = within(across);
  if (begin >= end) return;
  const TriangleSections sections(a, b, c, along);
  for (auto line = first; line < last; ++line) {
    std::multiset<std::uint32_t> visited;
    sections.visit(list[static_cast<std::size_t>(line)], list, 0.0, static_cast<std::uint32_t>(begin),
                   static_cast<std::uint32_t>(end), [&](std::uint32_t i) { visited.insert(i); });
    for (auto i = begin; i < end; ++i) {
      Vec3 at;
      at[along] = list[static_cast<std::size_t>(i)];
      at[across] = list[static_cast<std::size_t>(line)];
      const TriangleCrossing crossing = triangle_crossing(a, b, c, {at.y, at.z, xs});
      const bool concerned = crossing.sigma != 0 || crossing.ties > 0;
      const std::size_t times = visited.count(static_cast<std::uint32_t>(i));
      ASSERT_TRUE(times == 1 || (times == 0 && !concerned)) << "visited " << times << " times";
      counts.concerned += concerned;
      counts.visited += static_cast<int>(times);
      ++counts.all;
    }
  }
}

Counts expect_visits_of(const TriangleMesh& mesh, const std::vector<double>& list) {
  Counts counts;
  for (const Triangle& t : mesh.triangles) {
    for (const int along : {1, 2}) {
      expect_visits(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]], list, along, counts);
    }
  }
  return counts;
}

TEST(TriangleSections, VisitWhatTrianglesConcernAndLittleElse) {
  const DefaultFloatingPoint guard;
  test::Random random(1);
  std::vector<double> list;
  for (int i = 0; i <= 60; ++i) list.push_back(i / 60.0);
  const Counts counts = expect_visits_of(test::soup(random, 300), list);
  EXPECT_GT(counts.concerned, 10'000);
  EXPECT_LT(counts.visited, counts.concerned + counts.all / 8) << "of " << counts.all;
}

// Corners and rows on one integer lattice: ties along whole lines, edges along and across the sections, points.
TEST(TriangleSections, VisitAllTies) {
  const DefaultFloatingPoint guard;
  test::Random random(2);
  std::vector<double> list;
  for (int i = -1; i <= 7; ++i) list.push_back(i);
  EXPECT_GT(expect_visits_of(test::lattice_soup(random, 3000, 6), list).concerned, 10'000);
}

// Where the place of a line is known only up to rounding, the rows beside it are visited too.
TEST(TriangleSections, AllowForRounding) {
  const DefaultFloatingPoint guard;
  test::Random random(3);
  int concerned = 0;
  for (int i = 0; i < 2000; ++i) {
    TriangleMesh mesh = test::soup(random, 1);
    std::vector<double> list;
    for (const Vec3& v : mesh.vertices) list.insert(list.end(), {v.y, v.z});
    // Points next to the edges, and the neighbouring numbers of each.
    for (const double t : {0.25, 0.5, 0.7}) {
      const Vec3 p = mesh.vertices[0] + t * (mesh.vertices[1] - mesh.vertices[0]);
      for (const double x : {p.y, p.z}) list.insert(list.end(), {std::nextafter(x, -9), x, std::nextafter(x, 9)});
    }
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    concerned += expect_visits_of(mesh, list).concerned;
  }
  EXPECT_GT(concerned, 100'000);
}

// Slopes that overflow, and differences that are subnormal.
TEST(TriangleSections, SurviveExtremeSlopes) {
  const DefaultFloatingPoint guard;
  const std::vector<double> list{-0.5, -0x1p-1074, 0.0, 0x1p-1074, 0x1p-1060, 0.25, 0.5};
  const TriangleMesh mesh{{{0, -0.5, 0}, {0, 0.5, 0x1p-1074}, {0, 0.5, 0.5}, {0, -0.5, 0x1p-1060}},
                          {{0, 1, 2}, {0, 1, 3}, {1, 3, 2}}};
  EXPECT_GT(expect_visits_of(mesh, list).concerned, 0);
}

}  // namespace
}  // namespace raycone
