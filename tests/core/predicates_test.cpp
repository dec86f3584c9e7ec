#include "core/predicates.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/floating_point.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

int sign(__float128 x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }

// Exact for coordinates of at most 50 bits: products of differences fit 113 bits.
int side_by_definition(const Vec3& a, const Vec3& b, const Vec3& q) {
  using Quad = __float128;
  return sign((Quad(a.y) - q.y) * (Quad(b.z) - q.z) - (Quad(a.z) - q.z) * (Quad(b.y) - q.y));
}

TEST(EdgeSide, IsExactWhereRoundingWouldDecide) {
  // Points on a line up to a few units of 2^-50: the classical grid on which naive orientation fails.
  int naive_failures = 0;
  for (int i = -20; i <= 20; ++i) {
    for (int j = -20; j <= 20; ++j) {
      const Vec3 a{0, 12, 12}, b{0, 24, 24}, q{0, 0.5 + i * 0x1p-50, 0.5 + j * 0x1p-50};
      const int exact = side_by_definition(a, b, q);
      EXPECT_EQ(exact_edge_orientation(a, b, q), exact);
      EXPECT_EQ(edge_side(a, b, q).sign, exact != 0 ? exact : broken_tie(a, b).sign);
      EXPECT_EQ(edge_side(a, b, q).tie, exact == 0);
      const double naive = a.y * b.z - a.y * q.z - q.y * b.z - (a.z * b.y - a.z * q.y - q.z * b.y);
      naive_failures += sign(naive) != exact;
    }
  }
  EXPECT_GT(naive_failures, 100);  // else the grid tests nothing
}

// Coordinates of different magnitudes, so that their differences are rounded.
Vec3 point_of_many_bits(test::Random& random) {
  const auto coordinate = [&] { return std::ldexp(test::uniform(random, -1, 1), -static_cast<int>(random() % 8)); };
  const double x = coordinate(), y = coordinate();
  return {x, y, coordinate()};
}

// Queries rounded onto the edge, where the floating-point sign is wrong for one in several; at the smaller scales its
// products underflow.
TEST(EdgeSide, IsExactForQueriesRoundedOntoTheEdge) {
  test::Random random(5);
  const DefaultFloatingPoint guard;
  for (const double scale : {1.0, 0x1p-500, 0x1p-510, 0x1p-515, 0x1p-520, 0x1p-1000, 0x1p500}) {
    int misjudged = 0;
    for (int i = 0; i < 50000; ++i) {
      const Vec3 a = scale * point_of_many_bits(random), b = scale * point_of_many_bits(random);
      const double t = test::uniform(random, 0, 1);
      const Vec3 q{0, a.y + t * (b.y - a.y), a.z + t * (b.z - a.z)};
      const int exact = exact_edge_orientation(a, b, q);
      ASSERT_EQ(edge_side(a, b, q).sign, exact != 0 ? exact : broken_tie(a, b).sign) << scale;
      misjudged += sign(edge_determinant(a, b, q).value) != exact;
    }
    EXPECT_GT(misjudged, 1000) << scale;  // else nothing has been tested
  }
}

TEST(EdgeSide, IsAntisymmetricAlsoAtTies) {
  test::Random random(3);
  int ties = 0;
  for (int i = 0; i < 20000; ++i) {
    std::array<Vec3, 3> p;
    for (Vec3& v : p) {
      v = {0, static_cast<double>(random() % 5), static_cast<double>(random() % 5)};
    }
    const EdgeSide ab = edge_side(p[0], p[1], p[2]), ba = edge_side(p[1], p[0], p[2]);
    EXPECT_EQ(ab.sign, -ba.sign);
    EXPECT_EQ(ab.tie, ba.tie);
    ties += ab.tie;
  }
  EXPECT_GT(ties, 1000);
}

TEST(EdgeSide, TiesAreDecidedAsByATinyStepOfTheQuery) {
  test::Random random(4);
  for (int i = 0; i < 20000; ++i) {
    std::array<Vec3, 3> p;
    for (Vec3& v : p) v = {0, static_cast<double>(random() % 4), static_cast<double>(random() % 4)};
    const Vec3 moved{0, p[2].y + 0x1p-20, p[2].z + 0x1p-40};
    EXPECT_EQ(edge_side(p[0], p[1], p[2]).sign, side_by_definition(p[0], p[1], moved));
  }
}

TEST(EdgeSide, IsRightAtEveryMagnitude) {
  for (const double scale : {0x1p-1000, 0x1p-600, 0x1p-300, 1.0, 0x1p300, 0x1p600, 0x1p1000}) {
    for (int i = -2; i <= 2; ++i) {
      const Vec3 a{0, 1 * scale, 2 * scale}, b{0, 3 * scale, 6 * scale};
      const Vec3 q{0, 2 * scale, (4 + i * 0x1p-50) * scale};
      // q above the line z = 2 y: D > 0; on it the tie goes to the sign of a_z - b_z < 0.
      EXPECT_EQ(edge_side(a, b, q).sign, i > 0 ? 1 : -1) << scale << " " << i;
      EXPECT_EQ(edge_side(a, b, q).tie, i == 0) << scale;
    }
  }
}

TEST(PlaneSide, FrontIsPositiveAndThePlaneIsZero) {
  const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0};
  EXPECT_EQ(plane_side(a, b, c, {0.3, 0.3, 1e-300}), 1);
  EXPECT_EQ(plane_side(a, b, c, {0.3, 0.3, -1e-300}), -1);
  EXPECT_EQ(plane_side(a, b, c, {7.0, 0.3, 0.0}), 0);
}

TEST(OnTriangle, InsideEdgeVertexAndNotBeyond) {
  const Vec3 a{0, 0, 0}, b{4, 0, 4}, c{0, 4, 4};
  EXPECT_TRUE(on_triangle(a, b, c, {1, 1, 2}));
  EXPECT_TRUE(on_triangle(a, b, c, {2, 0, 2}));
  EXPECT_TRUE(on_triangle(a, b, c, a));
  EXPECT_FALSE(on_triangle(a, b, c, {1, 1, 2.0000000000000004}));
  EXPECT_FALSE(on_triangle(a, b, c, {3, 3, 6}));
  EXPECT_FALSE(on_triangle(a, b, c, {2, -1e-300, 2}));
}

TEST(OnTriangle, ParallelToTheRay) {
  const Vec3 a{0, 0, 0}, b{4, 0, 0}, c{0, 0, 4};  // in the plane y = 0
  EXPECT_TRUE(on_triangle(a, b, c, {1, 0, 1}));
  EXPECT_FALSE(on_triangle(a, b, c, {3, 0, 3}));
}

TEST(OnTriangle, OfZeroAreaIsASegmentOrAPoint) {
  const Vec3 a{0, 0, 0}, b{1, 2, 3}, c{3, 6, 9};
  EXPECT_TRUE(on_triangle(a, b, c, {2, 4, 6}));
  EXPECT_FALSE(on_triangle(a, b, c, {4, 8, 12}));
  EXPECT_FALSE(on_triangle(a, b, c, {2, 4, 6.5}));
  EXPECT_TRUE(on_triangle(b, b, b, b));
  EXPECT_FALSE(on_triangle(b, b, b, a));
}

TEST(MeetingSide, OfAnEdgeCrossingTheLine) {
  const Vec3 a{0, -1, 0}, b{2, 1, 0};  // meets the x axis at x = 1
  EXPECT_EQ(meeting_side(a, b, {0, 0, 0}), 1);
  EXPECT_EQ(meeting_side(b, a, {0, 0, 0}), 1);
  EXPECT_EQ(meeting_side(a, b, {1, 0, 0}), 0);
  EXPECT_EQ(meeting_side(a, b, {1.5, 0, 0}), -1);
  const Vec3 c{0, 0, -1}, d{2, 0, 1};
  EXPECT_EQ(meeting_side(c, d, {0, 0, 0}), 1);
  EXPECT_EQ(meeting_side(d, c, {2, 0, 0}), -1);
}

TEST(DefaultFloatingPoint, UndoesFlushToZeroAndRestoresIt) {
  const unsigned before = _mm_getcsr();
  _mm_setcsr(before | 0x8040U);
  EXPECT_FALSE(DefaultFloatingPoint::holds());
  {
    const DefaultFloatingPoint guard;
    EXPECT_TRUE(DefaultFloatingPoint::holds());
    EXPECT_EQ(exact_edge_orientation({0, 1e-160, 2e-160}, {0, 3e-160, 6.1e-160}, {0, 0, 0}), 1);
  }
  EXPECT_FALSE(DefaultFloatingPoint::holds());
  _mm_setcsr(before);
}

}  // namespace
}  // namespace raycone
