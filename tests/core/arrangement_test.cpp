#include "core/arrangement/arrangement.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/arrangement/arranged_patches.h"
#include "core/machine/threads.h"
#include "core/mesh/weld.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

constexpr std::size_t kEnough = 1 << 16;

Vec3 area_of(const Arrangement& arrangement, std::size_t n) {
  const auto& [a, b, c] = arrangement.triangles()[n];
  const Vec3 at = arrangement.rounded(a);
  return 0.5 * cross(arrangement.rounded(b) - at, arrangement.rounded(c) - at);
}

TriangleMesh two_boxes() {
  return test::joined(test::box_mesh({0, 0, 0}, {2, 2, 2}), test::box_mesh({1, 1, 1}, {3, 3, 3}));
}

TEST(Arrangement, IsTheMeshWhereNothingMeets) {
  const TriangleMesh sphere = test::sphere(9);
  const std::optional<Arrangement> arrangement = Arrangement::of(sphere, 0);
  ASSERT_TRUE(arrangement);
  EXPECT_EQ(arrangement->triangles(), sphere.triangles);
  EXPECT_EQ(patches_of(*arrangement).value().largest.size(), 1U);
}

// Pieces make up the faces that they are of, as vectors of areas, and lie in their planes.
TEST(Arrangement, CutsFacesIntoPieces) {
  test::Random random(1);
  for (int round = 0; round < 40; ++round) {
    const TriangleMesh mesh = test::lattice_soup(random, 12, 3 + round % 3);
    std::optional<Arrangement> arrangement = Arrangement::of(mesh, kEnough);
    ASSERT_TRUE(arrangement);
    Vec3 of_mesh, of_pieces;
    for (const auto& [a, b, c] : mesh.triangles)
      of_mesh = of_mesh + 0.5 * cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]);
    for (std::size_t n = 0; n < arrangement->triangles().size(); ++n) {
      of_pieces = of_pieces + static_cast<double>(arrangement->multiplicity(n)) * area_of(*arrangement, n);
      const auto& [a, b, c] = mesh.triangles[arrangement->source(n)];
      for (const std::uint32_t corner : arrangement->triangles()[n]) {
        const ExactPoints::Number point = arrangement->point(corner);
        EXPECT_EQ(arrangement->points().side({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]}, point), 0);
      }
    }
    EXPECT_LT(norm(of_mesh - of_pieces), 1e-12) << round;  // roundings of corners, of some hundred pieces
  }
}

TEST(Arrangement, LeavesOutWhatCancels) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const TriangleMesh both = test::joined(box, test::reversed(box));
  EXPECT_TRUE(Arrangement::of(both, kEnough).value().triangles().empty());
  const Arrangement twice = Arrangement::of(test::joined(box, box), kEnough).value();
  EXPECT_EQ(twice.triangles().size(), 12U);
  for (std::size_t n = 0; n < 12; ++n) EXPECT_EQ(twice.multiplicity(n), 2);
}

TEST(Arrangement, HasPatchesBetweenCurvesWhereFacesMeet) {
  const Arrangement arrangement = Arrangement::of(two_boxes(), kEnough).value();
  EXPECT_EQ(patches_of(arrangement).value().largest.size(), 4U);  // of each box, within the other and beyond
  EXPECT_FALSE(patches_of(Arrangement::of(test::open_box(), kEnough).value()));
}

TEST(Arrangement, IsNoneWhereMoreMeetThanAllowed) {
  EXPECT_TRUE(Arrangement::of(two_boxes(), 100));
  EXPECT_FALSE(Arrangement::of(two_boxes(), 5));
}

TEST(Arrangement, IsTheSameForAnyNumberOfThreads) {
  test::Random random(2);
  TriangleMesh mesh = test::soup(random, 600);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {  // small, in some places only
    const Vec3& middle = mesh.vertices[v / 12 * 12];
    if (v % 12 != 0) mesh.vertices[v] = middle + 0.1 * (mesh.vertices[v] - middle);
  }
  mesh = weld(mesh, {});
  const auto with = [&](int threads) {
    const ThreadLimit limit(threads);
    const Arrangement arrangement = Arrangement::of(mesh, kEnough).value();
    std::vector<Vec3> corners;
    for (std::uint32_t corner = 0; corner < arrangement.corners(); ++corner) {
      corners.push_back(arrangement.rounded(corner));
    }
    return std::make_pair(arrangement.triangles(), corners);
  };
  EXPECT_EQ(with(1), with(2));
  EXPECT_EQ(with(1), with(5));
  EXPECT_GT(with(1).first.size(), 2 * mesh.triangles.size());  // many meet
}

}  // namespace
}  // namespace raycone
