#include "core/ray_caster.h"

#include <gtest/gtest.h>
#include <xmmintrin.h>

#include <algorithm>
#include <array>

#include "core/projected_tree.h"
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

void find(const RayCaster& rays, const Vec3& q, std::vector<std::uint32_t>& candidates) {
  rays.find_candidates(q, candidates);
}

// In a group with neighbours and with a distant one, which must get the same as alone.
void find(const ProjectedTree& tree, const Vec3& q, std::vector<std::uint32_t>& candidates) {
  candidates.clear();
  std::vector<std::uint32_t> in_group, far_apart;
  const std::array<Vec3, 3> near{q + Vec3{-1, 1e-9, 0}, q, q + Vec3{1, 0, 1e-9}};
  const std::array<Vec3, 2> distant{q, q + Vec3{0, 1e9, 0}};
  tree.find({&q, 1}, [&](std::size_t, std::uint32_t triangle) { candidates.push_back(triangle); });
  tree.find(near, [&](std::size_t i, std::uint32_t triangle) {
    if (i == 1) in_group.push_back(triangle);
  });
  tree.find(distant, [&](std::size_t i, std::uint32_t triangle) {
    if (i == 0) far_apart.push_back(triangle);
  });
  EXPECT_EQ(far_apart, candidates);
  std::sort(in_group.begin(), in_group.end());
  std::vector<std::uint32_t> sorted = candidates;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(in_group, sorted);
}

template <class Finder>
std::uint64_t check_candidates(const TriangleMesh& mesh, const std::vector<Vec3>& origins) {
  const Finder rays(mesh);
  std::vector<std::uint32_t> candidates;
  std::uint64_t total = 0;
  for (const Vec3& q : origins) {
    find(rays, q, candidates);
    std::sort(candidates.begin(), candidates.end());
    EXPECT_EQ(std::adjacent_find(candidates.begin(), candidates.end()), candidates.end()) << "reported twice";
    const std::vector<std::uint32_t> needed = triangles_along(mesh, q);
    EXPECT_TRUE(std::includes(candidates.begin(), candidates.end(), needed.begin(), needed.end()));
    total += needed.size();
  }
  return total;
}

// Both ways to find the triangles along a ray.
template <class Finder>
class CandidateFinder : public testing::Test {};
using Finders = testing::Types<RayCaster, ProjectedTree>;
TYPED_TEST_SUITE(CandidateFinder, Finders);

TYPED_TEST(CandidateFinder, FindsEveryTriangleOfDegenerateLattices) {
  test::Random random(1);
  const TriangleMesh mesh = test::random_cells(random, 12);
  std::vector<Vec3> origins;
  for (int j = 0; j <= 24; ++j) {
    for (int k = 0; k <= 24; ++k) origins.push_back({-1.0 + j % 5, 0.5 * j, 0.5 * k});
  }
  EXPECT_GT(check_candidates<TypeParam>(mesh, origins), 10000U);
}

TYPED_TEST(CandidateFinder, FindsEveryTriangleThroughVerticesOfARealisticMesh) {
  for (const auto& [factors, shift] :
       {std::pair<Vec3, Vec3>{{1, 1, 1}, {0, 0, 0}}, {{1, 1e7, 1e-7}, {3, 5e5, 4.6e6}}}) {
    const TriangleMesh mesh = test::moved(test::sphere(40), factors, shift);
    std::vector<Vec3> origins;
    for (const Vec3& v : mesh.vertices) {
      origins.push_back(v);
      origins.push_back({shift.x - 10 * factors.x, v.y, v.z});
    }
    EXPECT_GT(check_candidates<TypeParam>(mesh, origins), 10000U);
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
