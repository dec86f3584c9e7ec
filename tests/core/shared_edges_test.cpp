// Boundaries of sets of triangles, against sums of directed edges.
#include "core/far/shared_edges.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "core/boundary/solid_angles.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using Key = std::array<double, 3>;
using Edges = std::map<std::pair<Key, Key>, int>;  // from the lower end to the higher one

void add(const Vec3& from, const Vec3& to, int times, Edges& edges) {
  if (from.y == to.y && from.z == to.z) return;
  const Key a{from.x, from.y, from.z}, b{to.x, to.y, to.z};
  const std::pair key = a < b ? std::pair(a, b) : std::pair(b, a);
  const int sum = edges[key] += a < b ? times : -times;
  if (sum == 0) edges.erase(key);
}

Edges sum_of(std::span<const SolidTriangle> triangles, std::span<const std::uint32_t> numbers) {
  Edges edges;
  for (const std::uint32_t n : numbers) {
    const SolidTriangle& t = triangles[n];
    const int times = t.orientation < 0 ? -1 : 1;
    add(t.a, t.b, times, edges);
    add(t.b, t.c, times, edges);
    add(t.c, t.a, times, edges);
  }
  return edges;
}

Edges sum_of(std::span<const ChainStep> steps) {
  Edges edges;
  for (std::size_t i = 1; i < steps.size(); ++i) {
    if (steps[i].joined) add(steps[i - 1].to, steps[i].to, steps[i].reversed ? -1 : 1, edges);
  }
  return edges;
}

std::size_t count_of(const Edges& edges) {
  std::size_t count = 0;
  for (const auto& [edge, times] : edges) count += static_cast<std::size_t>(std::abs(times));
  return count;
}

TEST(SharedEdges, BoundariesAreSumsOfDirectedEdges) {
  test::Random random(1);
  TriangleMesh mesh = test::sphere(8);  // with edges along the rays
  const std::size_t faces = mesh.triangles.size();
  for (std::size_t n = 0; n < faces; n += 3) mesh.triangles.push_back(mesh.triangles[n]);  // twice
  const std::vector<SolidTriangle> triangles = solid_faces(mesh).triangles;
  const SharedEdges edges(triangles);
  SharedEdges::Boundary boundary(edges);
  std::size_t multiple = 0;
  for (int round = 0; round < 200; ++round) {
    std::vector<std::uint32_t> some;
    const auto kept = static_cast<std::uint32_t>(round % 9);
    for (std::uint32_t n = 0; n < triangles.size(); ++n) {
      if (random() % 8 < kept) some.push_back(n);
    }
    const Edges expected = sum_of(triangles, some);
    const std::size_t count = count_of(expected);
    if (count > 0) {
      ASSERT_FALSE(boundary.of(some, count - 1));
    }
    const auto steps = boundary.of(some, count);
    ASSERT_TRUE(steps);
    ASSERT_EQ(sum_of(*steps), expected);
    if (count > expected.size()) ++multiple;
  }
  EXPECT_GT(multiple, 100U);
}

// One vertex is looked at once for two edges.
TEST(SharedEdges, LoopsAreChains) {
  const std::vector<SolidTriangle> triangles = solid_faces(test::open_box()).triangles;
  const SharedEdges edges(triangles);
  SharedEdges::Boundary boundary(edges);
  std::vector<std::uint32_t> all;
  for (std::uint32_t n = 0; n < triangles.size(); ++n) all.push_back(n);
  const std::size_t count = count_of(sum_of(triangles, all));
  EXPECT_FALSE(boundary.of(all, count - 1));
  const auto steps = boundary.of(all, count);
  ASSERT_TRUE(steps);
  std::size_t chains = 0;
  for (const ChainStep& step : *steps) chains += step.joined ? 0U : 1U;
  EXPECT_EQ(steps->size(), count + chains);
  EXPECT_LE(chains, 2U);  // edges along the rays cut the loop
}

}  // namespace
}  // namespace raycone
