#include "core/exact/exact_points.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

TriangleMesh with_vertices(const std::vector<Vec3>& vertices) {
  TriangleMesh mesh{vertices, {}};
  for (std::uint32_t v = 0; v < vertices.size(); ++v) mesh.triangles.push_back({v, v, v});
  return mesh;
}

int sign(std::int64_t x) { return static_cast<int>(x > 0) - static_cast<int>(x < 0); }

// Small integers: any formula is exact.
Vec3 lattice_point(test::Random& random, double size) {
  const auto coordinate = [&] { return std::floor(test::uniform(random, -size, size + 1.0)); };
  const double x = coordinate(), y = coordinate(), z = coordinate();
  return {x, y, z};
}

std::int64_t whole(double x) { return static_cast<std::int64_t>(x); }

TEST(ExactPoints, TurnsAsIntegersDo) {
  test::Random random(1);
  int ties = 0;
  for (int n = 0; n < 20000; ++n) {
    const std::array points{lattice_point(random, 3), lattice_point(random, 3), lattice_point(random, 3)};
    ExactPoints exact(with_vertices({points[0], points[1], points[2], {7, 0, 0}}));
    const auto a = exact.add(points[0]), b = exact.add(points[1]), c = exact.add(points[2]);
    for (int axis = 0; axis < 3; ++axis) {
      const int right = (axis + 1) % 3, up = (axis + 2) % 3;
      const Vec3 ab = points[1] - points[0], ac = points[2] - points[0];
      const int expected = sign(whole(ab[right]) * whole(ac[up]) - whole(ab[up]) * whole(ac[right]));
      ASSERT_EQ(exact.turn(axis, a, b, c), expected);
      ASSERT_EQ(exact.turn(axis, points[0], points[1], c), expected);
      ties += expected == 0 ? 1 : 0;
    }
  }
  EXPECT_GT(ties, 1000);
}

TEST(ExactPoints, IsOnTheSidesThatIntegersSay) {
  test::Random random(2);
  int ties = 0;
  for (int n = 0; n < 20000; ++n) {
    const std::array points{lattice_point(random, 2), lattice_point(random, 2), lattice_point(random, 2),
                            lattice_point(random, 2)};
    ExactPoints exact(with_vertices({points[0], points[1], points[2], points[3], {7, 0, 0}}));
    const Vec3 normal = cross(points[1] - points[0], points[2] - points[0]);
    const int expected = sign(whole(dot(normal, points[3] - points[0])));
    ASSERT_EQ(exact.side({points[0], points[1], points[2]}, exact.add(points[3])), expected);
    ties += expected == 0 ? 1 : 0;
  }
  EXPECT_GT(ties, 1000);
}

// Powers of two change no sign, though products overflow or underflow: of some alone, of sums of them, of all.
TEST(ExactPoints, IsOnTheSameSidesAtAnyScale) {
  test::Random random(3);
  for (int n = 0; n < 4000; ++n) {
    const double scale = std::ldexp(1.0, n % 2 == 0 ? 338 + n % 7 : n % 4 == 1 ? 508 + n % 7 : -350 - n % 40);
    std::array<Vec3, 4> points;
    for (Vec3& p : points) p = lattice_point(random, 2);
    const Vec3 ab = points[1] - points[0], ac = points[2] - points[0];
    const int expected = sign(whole(dot(cross(ab, ac), points[3] - points[0])));
    const int turn = sign(whole(ab.x) * whole(ac.y) - whole(ab.y) * whole(ac.x));
    for (Vec3& p : points) p = scale * p;
    ExactPoints exact(with_vertices({points[0], points[1], points[2], points[3], {7, 0, 0}}));
    ASSERT_EQ(exact.side({points[0], points[1], points[2]}, exact.add(points[3])), expected) << scale;
    ASSERT_EQ(exact.turn(2, points[0], points[1], exact.add(points[2])), turn) << scale;
    ASSERT_EQ(exact.turn(2, exact.add(points[0]), exact.add(points[1]), exact.add(points[2])), turn) << scale;
  }
}

// A point between corners that doubles cannot hold: on the lines and planes that it is made of, and beside others by
// less than doubles tell.
TEST(ExactPoints, HoldsWhatDoublesCannot) {
  const Vec3 a{0.1, 0.2, 0.3}, b{0.7, -0.3, 0.9}, c{-0.4, 0.8, 0.5}, from{0.3, 0.1, -1.0}, to{0.1, 0.3, 2.0};
  ExactPoints points(with_vertices({a, b, c, from, to}));
  const auto on_plane = points.add(std::vector<ExactPoints::OnPlane>{{from, to, {a, b, c}}}).at(0);
  EXPECT_EQ(points.side({a, b, c}, on_plane), 0);
  EXPECT_EQ(points.side({a, b, c}, points.add(from)), -points.side({a, b, c}, points.add(to)));
  for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(points.turn(axis, from, to, on_plane), 0);
  // The rounded point is a point of its own, on neither.
  const Vec3 nearest = points.rounded(on_plane);
  ExactPoints with_nearest(with_vertices({a, b, c, from, to, nearest}));
  EXPECT_NE(with_nearest.side({a, b, c}, with_nearest.add(nearest)), 0);
}

TEST(ExactPoints, KnowsAPointByItsPlaceHoweverItIsMade) {
  const Vec3 a{0, 0, 0}, b{3, 0, 0}, c{0, 3, 0}, d{0, 0, 3}, inner{1, 1, 0};
  const Vec3 diagonal{2, 2, 0}, right{2, 0, 0}, up{0, 2, 0};
  ExactPoints points(with_vertices({a, b, c, d, inner, {1, 1, 5}, {1, 1, -3}, diagonal, right, up}));
  const auto corner_a = points.add(a), corner_b = points.add(b), corner_c = points.add(c), vertex = points.add(inner);
  EXPECT_EQ(points.add({-0.0, 0.0, -0.0}), corner_a);
  EXPECT_EQ(points.add_between({corner_a, corner_b, corner_c}, {5, 5, 5}), vertex);
  const std::vector<ExactPoints::OnPlane> on_plane{{{1, 1, 5}, {1, 1, -3}, {a, b, c}}};
  EXPECT_EQ(points.add(on_plane), std::vector{vertex});
  const std::vector<ExactPoints::Crossing> crossing{
      {2, corner_a, points.add(diagonal), points.add(right), points.add(up)}};
  EXPECT_EQ(points.add(crossing), std::vector{vertex});
  EXPECT_NE(points.add_between({corner_a, corner_b, corner_c}, {5, 5, 6}), vertex);
  const auto size = points.size();
  EXPECT_EQ(points.add(b), corner_b);
  EXPECT_EQ(points.size(), size);
}

// By several threads, too, which are not done in this order.
TEST(ExactPoints, NumbersManyInTheirOrder) {
  const Vec3 a{0, 0, 0}, b{8, 0, 0}, c{0, 8, 0};
  std::vector<ExactPoints::OnPlane> all;
  for (int n = 0; n < 10000; ++n) {
    const double x = (n % 3000) / 1024.0;  // after three thousand the same points come again
    all.push_back({{x, 1, 1}, {x, 1, -2}, {a, b, c}});
  }
  std::vector<Vec3> vertices{a, b, c};
  for (const auto& [from, to, plane] : all) vertices.insert(vertices.end(), {from, to});
  ExactPoints points(with_vertices(vertices));
  const std::vector<ExactPoints::Number> numbers = points.add(all);
  ASSERT_EQ(numbers.size(), all.size());
  for (std::size_t n = 0; n < all.size(); ++n) {
    ASSERT_EQ(numbers[n], n % 3000);
    ASSERT_EQ(points.rounded(numbers[n]), (Vec3{all[n].from.x, 1, 0}));
  }
}

// x = 1/3, and others, to the last bit.
TEST(ExactPoints, RoundsToTheNearestDouble) {
  const Vec3 a{0, 0, 0}, b{1, -2, 5}, c{1024, 1, 0};
  ExactPoints points(with_vertices({a, b, c}));
  const auto origin = points.add(a), one = points.add(b), far = points.add(c);
  for (std::uint32_t weight = 1; weight < 3000; ++weight) {
    const Vec3 rounded = points.rounded(points.add_between({origin, one, far}, {weight, 1, 0}));
    ASSERT_EQ(rounded, (Vec3{1.0 / (weight + 1.0), -2.0 / (weight + 1.0), 5.0 / (weight + 1.0)})) << weight;
  }
}

// Where coordinates span all exponents that a mesh may have, nothing is rounded either.
TEST(ExactPoints, HoldsCoordinatesOfAllSizes) {
  const Vec3 tiny{0x1p-1074, 0, 0}, large{0, 0x1p+1000, 0}, origin{0, 0, 0};
  ExactPoints points(with_vertices({tiny, large, origin}));
  const auto a = points.add(origin), b = points.add(tiny), c = points.add(large);
  EXPECT_EQ(points.turn(2, a, b, c), 1);
  EXPECT_EQ(points.turn(2, a, c, b), -1);
  const auto middle = points.add_between({b, c, a}, {1, 1, 0});
  EXPECT_EQ(points.turn(2, b, c, middle), 0);
  EXPECT_EQ(points.turn(2, a, c, middle), -1);  // half of the least number to the right
}

TEST(ExactPoints, HasATriangleAroundAllOfTheMesh) {
  const std::vector<Vec3> corners{{-7.9, 7.9, 7.9}, {7.9, -7.9, 7.9}, {7.9, 7.9, -7.9}, {-7.9, -7.9, -7.9}};
  ExactPoints points(with_vertices(corners));
  for (int axis = 0; axis < 3; ++axis) {
    const auto around = points.add_triangle_around(axis);
    for (const Vec3& corner : corners) {
      for (std::size_t i = 0; i < 3; ++i)
        EXPECT_EQ(points.turn(axis, around[i], around[(i + 1) % 3], points.add(corner)), 1);
    }
  }
}

}  // namespace
}  // namespace raycone
