#include "core/crossings/ray_caster.h"

#include <gtest/gtest.h>
#include <xmmintrin.h>

#include <algorithm>

#include "tests/support/shapes.h"

namespace raycone {
namespace {

// Triangles whose closed box meets the closed ray, by definition.
std::vector<std::uint32_t> triangles_along(const TriangleMesh& mesh, const Vec3& q) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const bool across = std::min({a.y, b.y, c.y}) <= q.y && q.y <= std::max({a.y, b.y, c.y}) &&
                        std::min({a.z, b.z, c.z}) <= q.z && q.z <= std::max({a.z, b.z, c.z});
    if (across && q.x <= std::max({a.x, b.x, c.x})) found.push_back(i);
  }
  return found;
}

std::uint64_t check_candidates(const TriangleMesh& mesh, const std::vector<Vec3>& origins) {
  const RayCaster rays(mesh);
  std::vector<std::uint32_t> candidates;
  std::uint64_t total = 0;
  for (const Vec3& q : origins) {
    rays.find_candidates(q, candidates);
    std::sort(candidates.begin(), candidates.end());
    EXPECT_EQ(std::adjacent_find(candidates.begin(), candidates.end()), candidates.end()) << "reported twice";
    const std::vector<std::uint32_t> needed = triangles_along(mesh, q);
    EXPECT_TRUE(std::includes(candidates.begin(), candidates.end(), needed.begin(), needed.end()));
    total += needed.size();
  }
  return total;
}

TEST(RayCaster, FindsEveryTriangleOfDegenerateLattices) {
  test::Random random(1);
  const TriangleMesh mesh = test::random_cells(random, 12);
  std::vector<Vec3> origins;
  for (int j = 0; j <= 24; ++j) {
    for (int k = 0; k <= 24; ++k) origins.push_back({-1.0 + j % 5, 0.5 * j, 0.5 * k});
  }
  EXPECT_GT(check_candidates(mesh, origins), 10000U);
}

TEST(RayCaster, FindsEveryTriangleThroughVerticesOfARealisticMesh) {
  for (const auto& [factors, shift] :
       {std::pair<Vec3, Vec3>{{1, 1, 1}, {0, 0, 0}}, {{1, 1e7, 1e-7}, {3, 5e5, 4.6e6}}}) {
    const TriangleMesh mesh = test::moved(test::sphere(40), factors, shift);
    std::vector<Vec3> origins;
    for (const Vec3& v : mesh.vertices) {
      origins.push_back(v);
      origins.push_back({shift.x - 10 * factors.x, v.y, v.z});
    }
    EXPECT_GT(check_candidates(mesh, origins), 10000U);
  }
}

TEST(RayCaster, BuildingLeavesTheFloatingPointEnvironmentAlone) {
  const unsigned before = _mm_getcsr();
  const TriangleMesh mesh = test::sphere(8);
  const RayCaster rays(mesh);
  EXPECT_EQ(_mm_getcsr() & 0xFFC0U, before & 0xFFC0U);
}

}  // namespace
}  // namespace raycone
