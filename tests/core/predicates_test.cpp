#include "core/exact/predicates.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "core/machine/floating_point.h"
#include "tests/support/exact_predicates.h"
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
      const int exact = test::exact_edge_side(a, b, q);
      ASSERT_EQ(exact_edge_orientation(a, b, q), exact) << scale;
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

// Corners and queries that tie as often as not, at every magnitude: coordinates of few bits, or one last bit off.
class NearTies {
 public:
  explicit NearTies(std::uint64_t seed) : random_(seed) {}

  [[nodiscard]] double scale() {
    constexpr std::array kScales{1.0, 0x1p-340, 0x1p-700, 0x1p-1020, 0x1p340, 0x1p700, 0x1p1018};
    return kScales[random_() % kScales.size()];
  }
  [[nodiscard]] Vec3 point(double scale) {
    const auto coordinate = [&] {
      const double x = scale * (static_cast<double>(random_() % 9) - 4);
      return random_() % 8 == 0 ? std::nextafter(x, random_() % 2 == 0 ? HUGE_VAL : -HUGE_VAL) : x;
    };
    const double x = coordinate(), y = coordinate();
    return {x, y, coordinate()};
  }
  [[nodiscard]] std::array<Vec3, 4> points() {
    const double size = scale();
    std::array<Vec3, 4> p;
    for (Vec3& v : p) v = point(size);
    if (random_() % 8 == 0) p[2] = 0.5 * p[0] + 0.5 * p[1];
    if (random_() % 4 == 0) p[3] = 0.5 * p[0] + 0.25 * p[1] + 0.25 * p[2];
    if (random_() % 4 == 0) p[3] = 0.5 * p[0] + 0.5 * p[1];
    return p;
  }

 private:
  test::Random random_;
};

TEST(Predicates, AreThoseOfIntegerArithmetic) {
  const DefaultFloatingPoint guard;
  NearTies ties(1);
  int on_plane = 0, on_line = 0, on_surface = 0, meeting = 0;
  for (int i = 0; i < 40000; ++i) {
    const auto [a, b, c, q] = ties.points();
    ASSERT_EQ(plane_side(a, b, c, q), test::exact_plane_side(a, b, c, q)) << i;
    ASSERT_EQ(collinear(a, b, c), test::exactly_collinear(a, b, c)) << i;
    ASSERT_EQ(on_triangle(a, b, c, q), test::exactly_on_triangle(a, b, c, q)) << i;
    on_plane += test::exact_plane_side(a, b, c, q) == 0;
    on_line += test::exactly_collinear(a, b, c);
    on_surface += test::exactly_on_triangle(a, b, c, q);
    if (test::exact_edge_side(a, b, q) != 0 || (a.y == b.y && a.z == b.z)) continue;
    // Where the line meets the edge's line, in 64 bits; sure beyond 1e-12 of the coordinates, all of them of one size.
    const int axis = a.y != b.y ? 1 : 2;
    const long double t = (static_cast<long double>(q[axis]) - a[axis]) / (static_cast<long double>(b[axis]) - a[axis]);
    const long double ahead = a.x + t * (static_cast<long double>(b.x) - a.x) - q.x;
    const double size = std::abs(a[axis]) + std::abs(b[axis]) + std::abs(a.x) + std::abs(b.x) + std::abs(q.x);
    const int side = meeting_side(a, b, q);
    ASSERT_EQ(side == 0, test::exactly_collinear(a, b, q)) << i;
    if (std::abs(ahead) <= 1e-12L * (1 + std::abs(t)) * size) continue;
    ASSERT_EQ(side, ahead > 0 ? 1 : -1) << i;
    ++meeting;
  }
  // Else nothing has been tested.
  EXPECT_GT(on_plane, 5000);
  EXPECT_GT(on_line, 1000);
  EXPECT_GT(on_surface, 2000);
  EXPECT_GT(meeting, 500);
}

// The oracle itself, where 113 bits are exact: on integers.
TEST(ExactPredicates, AreWhatSmallIntegersSay) {
  test::Random random(6);
  const auto coordinate = [&] { return static_cast<std::int64_t>(random() % 7) - 3; };
  int inside = 0;
  for (int i = 0; i < 20000; ++i) {
    std::array<std::array<std::int64_t, 3>, 4> n{};
    std::array<Vec3, 4> p;
    for (std::size_t k = 0; k < 4; ++k) {
      n[k] = {coordinate(), coordinate(), coordinate()};
      p[k] = {0.125 * static_cast<double>(n[k][0]), 0.125 * static_cast<double>(n[k][1]),
              0.125 * static_cast<double>(n[k][2])};
    }
    const auto minor = [&](std::size_t from, std::size_t k, std::size_t l, std::size_t x, std::size_t y) {
      return (n[k][x] - n[from][x]) * (n[l][y] - n[from][y]) - (n[k][y] - n[from][y]) * (n[l][x] - n[from][x]);
    };
    const std::int64_t volume = (n[3][0] - n[0][0]) * minor(0, 1, 2, 1, 2) +
                                (n[3][1] - n[0][1]) * minor(0, 1, 2, 2, 0) + (n[3][2] - n[0][2]) * minor(0, 1, 2, 0, 1);
    ASSERT_EQ(test::exact_plane_side(p[0], p[1], p[2], p[3]), (volume > 0) - (volume < 0));
    const std::int64_t side = minor(3, 0, 1, 1, 2);
    ASSERT_EQ(test::exact_edge_side(p[0], p[1], p[3]), (side > 0) - (side < 0));
    // On the triangle: the three parts of its area, made with q, add up to the whole, in each projection.
    const auto areas_agree = [&](std::size_t x, std::size_t y) {
      const auto area = [&](std::size_t k, std::size_t l, std::size_t m) { return std::abs(minor(k, l, m, x, y)); };
      return area(0, 1, 2) == area(3, 0, 1) + area(3, 1, 2) + area(3, 2, 0);
    };
    const bool flat = minor(0, 1, 2, 0, 1) == 0 && minor(0, 1, 2, 1, 2) == 0 && minor(0, 1, 2, 2, 0) == 0;
    ASSERT_EQ(test::exactly_collinear(p[0], p[1], p[2]), flat);
    if (flat) continue;
    const bool on = volume == 0 && areas_agree(0, 1) && areas_agree(1, 2) && areas_agree(2, 0);
    ASSERT_EQ(test::exactly_on_triangle(p[0], p[1], p[2], p[3]), on);
    inside += on;
  }
  EXPECT_GT(inside, 200);
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
