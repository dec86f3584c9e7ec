#include "core/filling/fill_faces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <tuple>
#include <vector>

#include "core/filling/closed_by_caps.h"
#include "core/mesh/exterior_edges.h"
#include "core/mesh/mesh_statistics.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

TEST(FillFaces, AddsOctahedra) {
  const TriangleMesh box = test::open_box();
  SurfaceMesh surface{closed_by_caps(box, exterior_edges(box)), {}};
  surface.sources.assign(12, 0);
  for (const FillFaces::Fronts fronts : {FillFaces::Fronts::kOutward, FillFaces::Fronts::kInward}) {
    FillFaces fill(surface);
    const std::uint32_t before = fill.size();
    const std::size_t edges = fill.inner_edges().size();
    const double volume = mesh_statistics(fill.mesh()).signed_volume.value();
    fill.add_octahedron({Vec3{3, 0, 0}, {6, 0, 0}, {4, -1, 0}, {4, 1, 0}, {4, 0, -2}, {4, 0, 1}}, fronts);
    fill.update_edges();
    EXPECT_EQ(fill.size(), before + 8);
    EXPECT_EQ(fill.inner_edges().size(), edges + 12);
    const double added = mesh_statistics(fill.mesh()).signed_volume.value() - volume;
    EXPECT_NEAR(added, fronts == FillFaces::Fronts::kOutward ? 3.0 : -3.0, 1e-12);  // a sixth of 3 times 2 times 3
    fill.put_back();
  }
}

TEST(FillFaces, DividesAndFlips) {
  const TriangleMesh box = test::open_box();
  SurfaceMesh surface{closed_by_caps(box, exterior_edges(box)), {}};
  surface.sources.assign(12, kHole);
  std::fill_n(surface.sources.begin(), 10, 0);
  FillFaces fill(surface);
  ASSERT_EQ(fill.size(), 2U);
  ASSERT_EQ(fill.inner_edges().size(), 1U);
  EXPECT_EQ(surface.sources.size(), 10U);
  fill.divide({0, 0}, {0.9, 0.8, 1.0});  // off the middle, so that flips are worth it
  fill.update_edges();
  EXPECT_EQ(fill.size(), 4U);
  fill.divide({2, FillFaces::kNone}, fill.middle(2));
  fill.update_edges();
  EXPECT_EQ(fill.size(), 6U);
  EXPECT_FALSE(fill.flip_edges().empty());
  double area = 0.0;
  for (std::uint32_t face = 0; face < fill.size(); ++face) {
    EXPECT_GT(fill.normal(face).z, 0.0);
    area += norm(fill.normal(face)) / 2;
  }
  EXPECT_NEAR(area, 1.0, 1e-14);
  for (const FillFaces::InnerEdge& edge : fill.inner_edges()) {  // Delaunay: no corner is in a neighbour's circle
    double opposite = 0.0;
    for (const std::uint32_t face : {edge.left, edge.right}) {
      const auto [a, b, c] = fill[face];
      const std::uint32_t apex = a ^ b ^ c ^ edge.from ^ edge.to;
      const Vec3 u = fill.at(edge.from) - fill.at(apex), v = fill.at(edge.to) - fill.at(apex);
      opposite += std::atan2(norm(cross(u, v)), dot(u, v));
    }
    EXPECT_LE(opposite, std::numbers::pi + 1e-5);
  }
  EXPECT_TRUE(exterior_edges(fill.mesh()).empty());
  fill.put_back();
  EXPECT_EQ(surface.sources.size(), 16U);
  EXPECT_EQ(std::ranges::count(surface.sources, kHole), 6);
}

using EdgeOfTwo = std::tuple<std::uint32_t, std::uint32_t, Triangle, Triangle>;

std::vector<EdgeOfTwo> inner_edges_of(const FillFaces& fill) {
  std::vector<EdgeOfTwo> edges;
  for (const auto& [from, to, left, right] : fill.inner_edges()) edges.emplace_back(from, to, fill[left], fill[right]);
  return edges;
}

// They are kept up to date, change by change: as those are that are found anew.
TEST(FillFaces, KeepsItsInnerEdges) {
  test::Random random(5);
  SurfaceMesh surface{test::sphere(6), {}};
  surface.sources.resize(surface.mesh.triangles.size(), 0);
  std::fill_n(surface.sources.begin(), surface.sources.size() / 2, kHole);
  std::size_t flipped = 0;
  for (int round = 0; round < 20; ++round) {
    FillFaces fill(surface);
    std::vector<bool> is_taken(fill.size(), false);
    for (int n = 0; n < 8; ++n) {
      const bool whole = n % 2 == 0;
      const auto any = [&](std::size_t count) { return static_cast<std::uint32_t>(random() % count); };
      const FillFaces::Part part = whole ? FillFaces::Part{any(is_taken.size())}
                                         : FillFaces::Part{FillFaces::kNone, any(fill.inner_edges().size())};
      const auto [one, other] = fill.faces_of(part);
      if (is_taken[one] || is_taken[other]) continue;
      is_taken[one] = is_taken[other] = true;
      fill.divide(part, 1.01 * fill.middle(one));
    }
    if (round % 4 == 0)
      fill.add_octahedron({Vec3{3, 0, 0}, {6, 0, 0}, {4, -1, 0}, {4, 1, 0}, {4, 0, -2}, {4, 0, 1}},
                          FillFaces::Fronts::kOutward);
    fill.update_edges();
    flipped += fill.flip_edges().size();
    const std::vector<EdgeOfTwo> kept = inner_edges_of(fill);
    fill.put_back();
    FillFaces anew(surface);
    EXPECT_EQ(inner_edges_of(anew), kept);
    anew.put_back();
  }
  EXPECT_GT(flipped, 20U);
}

}  // namespace
}  // namespace raycone
