#include "core/arrangement/snap.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <vector>

#include "core/certificate/certificate.h"
#include "core/mesh/components.h"
#include "core/mesh/exterior_edges.h"
#include "tests/support/border_sources.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

constexpr double kNear = 1e-9;

RuleBorder snapped(const TriangleMesh& mesh) {
  RuleBorder border{mesh, std::vector<std::uint32_t>(mesh.triangles.size())};
  std::iota(border.sources.begin(), border.sources.end(), 0);
  snap(border, kNear);
  EXPECT_TRUE(exterior_edges(border.mesh).empty());
  EXPECT_EQ(border.sources.size(), border.mesh.triangles.size());
  EXPECT_LE(test::farthest_from_source(border, mesh), 4 * kNear);
  return border;
}

// A box whose first face has a corner at the middle of its first side, off by so much; a face without height joins it
// to the side.
TriangleMesh with_flat_face(double off) {
  TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const auto [a, b, c] = box.triangles[0];
  const Vec3 towards = box.vertices[c] - box.vertices[b];
  box.vertices.push_back(0.5 * (box.vertices[a] + box.vertices[b]) + (off / norm(towards)) * towards);
  const auto middle = static_cast<std::uint32_t>(box.vertices.size() - 1);
  box.triangles[0] = {a, middle, c};
  box.triangles.push_back({middle, b, c});
  box.triangles.push_back({a, b, middle});
  return box;
}

TEST(Snap, LeavesWhatIsAsItShouldBe) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(snapped(box).mesh.triangles.size(), 12U);
  EXPECT_EQ(snapped(with_flat_face(1e-6)).mesh.triangles.size(), 14U);
}

TEST(Snap, SplitsSidesThatCornersAreNear) {
  for (const double off : {1e-12, -1e-12, 0.0}) {
    const RuleBorder border = snapped(with_flat_face(off));
    EXPECT_EQ(border.mesh.triangles.size(), 14U);  // the face is gone, and the other one at the side is two
    EXPECT_TRUE(is_closed_and_embedded(border.mesh));
  }
}

// As with_flat_face(), with many corners along the side, and flat faces from its beginning.
TriangleMesh with_flat_fan(std::uint32_t corners) {
  TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const auto [a, b, c] = box.triangles[0];
  const Vec3 along = box.vertices[b] - box.vertices[a];
  std::vector<std::uint32_t> side{a};
  for (std::uint32_t n = 1; n <= corners; ++n) {
    side.push_back(static_cast<std::uint32_t>(box.vertices.size()));
    box.vertices.push_back(box.vertices[a] + (n / (corners + 1.0)) * along);
  }
  side.push_back(b);
  box.triangles[0] = {side[0], side[1], c};
  for (std::size_t n = 1; n + 1 < side.size(); ++n) {
    box.triangles.push_back({side[n], side[n + 1], c});
    box.triangles.push_back({a, side[n + 1], side[n]});
  }
  return box;
}

TEST(Snap, SplitsSidesThatManyCornersAreNear) {
  for (const std::uint32_t corners : {2U, 10U, 700U}) {
    const RuleBorder border = snapped(with_flat_fan(corners));
    EXPECT_TRUE(is_closed_and_embedded(border.mesh)) << corners;
    EXPECT_EQ(border.mesh.triangles.size(), 12U + 2 * corners) << corners;
  }
}

// Turned about, so that roundings move corners off the lines that they are on: splits may go around.
TEST(Snap, NeverOpensABorder) {
  test::Random random(3);
  for (int n = 0; n < 12; ++n) {
    TriangleMesh mesh = with_flat_fan(40U << (n % 4));
    const auto axis = [&] { return test::uniform_point(random, {{-1, -1, -1}, {1, 1, 1}}); };
    const Vec3 x = axis(), y = axis(), z = cross(x, y);
    for (Vec3& p : mesh.vertices) p = p.x * x + p.y * y + p.z * z;
    RuleBorder border{mesh, std::vector<std::uint32_t>(mesh.triangles.size())};
    std::iota(border.sources.begin(), border.sources.end(), 0);
    const std::size_t faces = border.sources.size();
    snap(border, 0x1p-48);
    EXPECT_TRUE(exterior_edges(border.mesh).empty()) << n;
    EXPECT_LE(border.sources.size(), 8 * faces) << n;
  }
}

// A box, and between one of its faces and three that are nearly in it, a pocket without thickness.
TEST(Snap, CutsFacesThatCornersAreNear) {
  for (const double off : {1e-12, -1e-12}) {
    TriangleMesh mesh = test::box_mesh({0, 0, 0}, {1, 1, 1});
    const auto [a, b, c] = mesh.triangles[0];
    const Vec3 area = cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]);
    mesh.vertices.push_back(0.5 * mesh.vertices[a] + 0.25 * (mesh.vertices[b] + mesh.vertices[c]) + off * area);
    const auto middle = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
    mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {b, a, middle}, {c, b, middle}, {a, c, middle}});
    const RuleBorder border = snapped(mesh);
    EXPECT_TRUE(is_closed_and_embedded(border.mesh));
    EXPECT_LE(border.mesh.triangles.size(), 14U);
    EXPECT_EQ(components_of(border.mesh).count, 1U);
  }
}

TEST(Snap, MergesVerticesThatAreNear) {
  TriangleMesh sphere = test::sphere(6);  // of which triangles at the poles and along a seam do not share vertices
  for (std::uint32_t n = 0; n < sphere.vertices.size(); ++n) sphere.vertices[n].x += 1e-11 * (n % 3);
  EXPECT_TRUE(is_closed_and_embedded(snapped(sphere).mesh));
}

TEST(Snap, CancelsFacesThatAreOneInEitherDirection) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  TriangleMesh with_wall = box;
  with_wall.triangles.push_back({0, 1, 2});
  with_wall.triangles.push_back({1, 0, 2});
  const RuleBorder border = snapped(with_wall);
  EXPECT_EQ(border.mesh.triangles.size(), 12U);
  EXPECT_EQ(snapped(test::joined(box, test::reversed(box))).mesh.triangles.size(), 0U);
}

}  // namespace
}  // namespace raycone
