#include "core/mesh/weld.h"

#include <gtest/gtest.h>
#include <xmmintrin.h>

#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <tuple>
#include <vector>

#include "tests/support/shapes.h"

namespace raycone {
namespace {

TEST(Weld, MergesBitwiseEqualVerticesAndKeepsTheOrderOfFaces) {
  const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 0}, {0, 0, 1}}, {{0, 1, 2}, {3, 4, 5}}};
  const TriangleMesh welded = weld(mesh, {});
  EXPECT_EQ(welded.vertices.size(), 4U);
  EXPECT_EQ(welded.triangles[0], (Triangle{0, 1, 2}));
  EXPECT_EQ(welded.triangles[1], (Triangle{1, 0, 3}));
}

TEST(Weld, NegativeZeroIsZeroInEveryMode) {
  const TriangleMesh mesh{{{0.0, 1, 2}, {-0.0, 1, 2}, {5, -0.0, 5}}, {{0, 1, 2}}};
  EXPECT_EQ(weld(mesh, {}).vertices.size(), 2U);
  const TriangleMesh unmerged = weld(mesh, {WeldMode::kNone});
  EXPECT_EQ(unmerged.vertices.size(), 3U);
  EXPECT_FALSE(std::signbit(unmerged.vertices[1].x));
  EXPECT_FALSE(std::signbit(unmerged.vertices[2].y));
}

TEST(Weld, OneUlpApartIsTwoVertices) {
  const double next = std::nextafter(1.0, 2.0);
  EXPECT_EQ(weld({{{1, 0, 0}, {next, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}, {}).vertices.size(), 3U);
}

TEST(Weld, DistanceJoinsTheFirstRepresentativeInLexicographicOrder) {
  // 0 takes 0.9; 1.5 is too far from 0 and becomes its own; 2.4 joins 1.5.
  const TriangleMesh mesh{{{2.4, 0, 0}, {0.9, 0, 0}, {0, 0, 0}, {1.5, 0, 0}}, {{0, 1, 2}, {2, 3, 1}}};
  const TriangleMesh welded = weld(mesh, {WeldMode::kDistance, 1.0});
  ASSERT_EQ(welded.vertices.size(), 2U);
  const auto x = [&](std::size_t face, std::size_t corner) {
    return welded.vertices[welded.triangles[face][corner]].x;
  };
  EXPECT_EQ(x(0, 0), 1.5);
  EXPECT_EQ(x(0, 1), 0.0);
  EXPECT_EQ(x(0, 2), 0.0);
  EXPECT_EQ(x(1, 1), 1.5);
}

TEST(Weld, DistanceIsInclusiveAndWorksFarFromTheOrigin) {
  const TriangleMesh mesh{{{5e5, 4.6e6, 0}, {5e5 + 0.25, 4.6e6, 0}, {5e5, 4.6e6 - 0.5, 0}}, {{0, 1, 2}}};
  EXPECT_EQ(weld(mesh, {WeldMode::kDistance, 0.25}).vertices.size(), 2U);
  EXPECT_EQ(weld(mesh, {WeldMode::kDistance, 0.125}).vertices.size(), 3U);
}

TEST(Weld, DistanceDoesNotDependOnTheOrderOfVertices) {
  test::Random random(7);
  const TriangleMesh mesh = test::soup(random, 200);
  const Weld how{WeldMode::kDistance, 0.05};
  const auto representatives = [&](const TriangleMesh& m) { return weld(m, how).vertices; };
  const std::vector<Vec3> expected = representatives(mesh);
  EXPECT_LT(expected.size(), mesh.vertices.size());
  EXPECT_EQ(representatives(test::shuffled(mesh, random)), expected);
}

// More vertices than fit one piece of work: the first of each position stays, in their order.
TEST(Weld, LargeMeshesKeepTheFirstOfEachPosition) {
  test::Random random(11);
  TriangleMesh mesh;
  std::map<std::tuple<double, double, double>, std::uint32_t> kept;
  std::vector<Vec3> expected_vertices;
  std::vector<Triangle> expected_triangles;
  for (std::uint32_t i = 0; i < 210'000; ++i) {
    const auto coordinate = [&] { return std::uniform_int_distribution<int>(0, 40)(random) / 7.0; };
    const Vec3 p{coordinate(), coordinate(), coordinate()};
    mesh.vertices.push_back(p);
    const auto [place, is_new] = kept.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(kept.size()));
    if (is_new) expected_vertices.push_back(p);
    if (i % 3 == 0) {
      mesh.triangles.push_back({i, i + 1, i + 2});
      expected_triangles.emplace_back();
    }
    expected_triangles.back()[i % 3] = place->second;
  }
  const TriangleMesh welded = weld(mesh, {});
  EXPECT_EQ(welded.vertices, expected_vertices);
  EXPECT_EQ(welded.triangles, expected_triangles);
}

// Their hashes were the same for every seed that welding tried: it never ended.
TEST(Weld, NoTwoVerticesMakeItWaitForEver) {
  const TriangleMesh floats{{{1, 1.5, 0.25}, {-1, -1.500003814697265625, 0.25}, {0, 0, 1}}, {{0, 1, 2}}};
  const TriangleMesh integers{{{10, 262144, 5}, {-10, -262145, 5}, {0, 0, 1}}, {{0, 1, 2}}};
  for (const TriangleMesh& mesh : {floats, integers}) {
    EXPECT_EQ(weld(mesh, {}).vertices, mesh.vertices);
    EXPECT_EQ(weld(mesh, {}).triangles, mesh.triangles);
  }
}

TEST(Weld, OfNothingIsNothing) {
  for (const Weld& how : {Weld{}, Weld{WeldMode::kNone}, Weld{WeldMode::kDistance, 0.5}}) {
    EXPECT_TRUE(weld({}, how).vertices.empty());
  }
}

// As a thread is left by Embree.
TEST(Weld, KeepsTinyCoordinatesWhereTheyWouldBeFlushed) {
  const unsigned saved = _mm_getcsr();
  _mm_setcsr(saved | 0x8040U);
  const TriangleMesh welded = weld({{{5e-324, 0, 0}, {0, 5e-324, 0}, {0, 0, 0}}, {{0, 1, 2}}}, {});
  const TriangleMesh within =
      weld({{{5e-324, 0, 0}, {0, 0, 0}, {1e-323, 0, 0}}, {{0, 1, 2}}}, {WeldMode::kDistance, 5e-324});
  _mm_setcsr(saved);
  EXPECT_EQ(welded.vertices, (std::vector<Vec3>{{5e-324, 0, 0}, {0, 5e-324, 0}, {0, 0, 0}}));
  EXPECT_EQ(within.vertices, (std::vector<Vec3>{{0, 0, 0}, {1e-323, 0, 0}}));
}

TEST(Weld, UnusedNonFiniteVerticesDoNoHarm) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const TriangleMesh mesh{{{nan, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, inf, nan}, {0, 1, 0}}, {{1, 2, 4}}};
  for (const Weld& how : {Weld{}, Weld{WeldMode::kNone}, Weld{WeldMode::kDistance, 0.5}}) {
    const TriangleMesh welded = weld(mesh, how);
    EXPECT_EQ(welded.vertices[welded.triangles[0][2]], (Vec3{0, 1, 0}));
  }
}

}  // namespace
}  // namespace raycone
