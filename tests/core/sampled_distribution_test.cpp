// What is drawn has the distribution that docs/formats.md promises, on triangles of every shape and size.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/machine/threads.h"
#include "core/sampling/point_sampler.h"
#include "tests/support/shapes.h"
#include "tests/support/statistics.h"

namespace raycone {
namespace {

// 400 bits: more than the coordinates of any triangle here span, squared.
using Real =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<400, boost::multiprecision::digit_base_2>,
                                  boost::multiprecision::et_off>;
struct Vector {
  Real x, y, z;
};
Vector minus(const Vec3& a, const Vec3& b) { return {Real(a.x) - b.x, Real(a.y) - b.y, Real(a.z) - b.z}; }
Real dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vector cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

Vector normal_of(const std::array<Vec3, 3>& t) { return cross(minus(t[1], t[0]), minus(t[2], t[0])); }

double area_of(const std::array<Vec3, 3>& t) {
  const Vector n = normal_of(t);
  return static_cast<double>(Real(sqrt(dot(n, n)) / 2));
}

std::array<Vec3, 3> corners(const TriangleMesh& mesh, std::size_t face) {
  const Triangle& t = mesh.triangles[face];
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

// The three coordinates of p's projection in the triangle, of sum 1, and how far p is from its plane.
struct Place {
  std::array<double, 3> weights;
  double above;
};
Place place_of(const std::array<Vec3, 3>& t, const Vec3& p) {
  const Vector n = normal_of(t);
  const Real square = dot(n, n);
  Place place{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 &a = t[(i + 1) % 3], &b = t[(i + 2) % 3];
    place.weights[i] = static_cast<double>(Real(dot(cross(minus(b, a), minus(p, a)), n) / square));
  }
  place.above = static_cast<double>(Real(abs(dot(minus(p, t[0]), n)) / sqrt(square)));
  return place;
}

std::vector<Vec3> drawn(const TriangleMesh& mesh, std::uint64_t count, std::uint64_t seed = 1) {
  const PointSampler sampler(mesh, bounding_box(mesh), {NearSamples{count, 0.0}}, seed);
  EXPECT_TRUE(sampler.has_needed_area());
  EXPECT_TRUE(sampler.is_finite());
  std::vector<Vec3> points(count);
  sampler.draw(0, points);
  return points;
}

// Triangles that share no plane z = const: the level tells which one a point is from.
struct Levels {
  TriangleMesh mesh;

  void add(Vec3 a, Vec3 b, Vec3 c) {
    a.z = b.z = c.z = static_cast<double>(mesh.triangles.size());
    test::add_triangle(mesh, a, b, c);
  }
  // Points on each level, of a drawing of `count`.
  [[nodiscard]] std::vector<std::size_t> counts(std::uint64_t count) const {
    std::vector<std::size_t> counts(mesh.triangles.size(), 0);
    for (const Vec3& p : drawn(mesh, count)) {
      EXPECT_EQ(p.z, std::round(p.z));
      ++counts.at(static_cast<std::size_t>(p.z));
    }
    return counts;
  }
  [[nodiscard]] std::vector<double> shares() const {
    std::vector<double> areas;
    double sum = 0.0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      areas.push_back(area_of(corners(mesh, i)));
      sum += areas.back();
    }
    for (double& area : areas) area /= sum;
    return areas;
  }
};

Levels triangles_of_all_areas() {
  test::Random random(1);
  Levels levels;
  for (int i = 0; i < 60; ++i) {
    const double size = i % 3 == 0 ? std::pow(10.0, -15.0 * i / 60) : test::uniform(random, 0.1, 1);
    const Vec3 a = test::uniform_point(random, {{0, 0, 0}, {1, 1, 0}});
    levels.add(a, a + Vec3{size, 0.3 * size, 0}, a + Vec3{0.2 * size, size, 0});
    if (i % 4 == 0) levels.add(a, a + Vec3{3, 6, 0}, a + Vec3{1, 2, 0});  // but for rounding a segment
    if (i % 4 == 1) levels.add(a, a, {7, 7, 0});
  }
  return levels;
}

TEST(SampledFaces, AreDrawnByTheirAreas) {
  const Levels levels = triangles_of_all_areas();
  EXPECT_LE(test::chi_squared(levels.counts(100000), levels.shares()), 1);
}

TEST(SampledFaces, ControlsEqualSharesAndHalfAnArea) {  // negative controls of the test above
  const Levels levels = triangles_of_all_areas();
  const std::vector<std::size_t> counts = levels.counts(100000);
  EXPECT_GT(test::chi_squared(counts), 1);
  std::vector<double> shares = levels.shares();
  const auto largest = std::ranges::max_element(shares);
  const double moved = 0.2 * *largest;
  *largest -= moved;
  *std::ranges::max_element(shares) += moved;
  EXPECT_GT(test::chi_squared(counts, shares), 1);
}

// Their areas are what doubles lose: a cross product of their sides is all rounding.
TEST(SampledFaces, AreDrawnByTheirAreasWhereDoublesLoseThem) {
  test::Random random(2);
  Levels levels;
  for (int i = 0; i < 20; ++i) {
    const Box box{{-1, -1, 0}, {1, 1, 0}};
    const Vec3 a = test::uniform_point(random, box), b = test::uniform_point(random, box);
    levels.add(a, b, a + test::uniform(random, 0.1, 0.9) * (b - a));
  }
  EXPECT_LE(test::chi_squared(levels.counts(20000), levels.shares()), 1);
}

TEST(SampledFaces, ManySmallOnesBesideALargeOneHaveTheirShare) {
  TriangleMesh mesh{{{0, 0, 0}, {1000, 0, 0}, {0, 1000, 0}, {0, 0, 5}, {1, 0, 5}, {0, 1, 5}}, {{0, 1, 2}}};
  mesh.triangles.resize(1 + 1000000, Triangle{3, 4, 5});
  std::size_t small = 0;
  for (const Vec3& p : drawn(mesh, 40000)) small += p.z == 5;
  EXPECT_LE(test::chi_squared({small, 40000 - small}), 1);
}

// --- Within a triangle ---

// Of sides cut in eight; a point of an exact edge counts as one of its cells.
std::size_t cell_of(const std::array<double, 3>& weights) {
  constexpr double kSide = 8;
  std::array<int, 3> n{};
  for (std::size_t i = 0; i < 3; ++i) n[i] = std::clamp(static_cast<int>(weights[i] * kSide), 0, 7);
  const int down = n[0] + n[1] + n[2] < 7 ? 1 : 0;  // cells that stand on a corner
  return static_cast<std::size_t>(((n[0] * 8 + n[1]) * 2) + down);
}

// Of 64 cells; the other numbers are of none.
double uniformity(const std::vector<std::array<double, 3>>& weights) {
  std::vector<std::size_t> counts(128, 0);
  for (const auto& w : weights) ++counts[cell_of(w)];
  std::vector<std::size_t> of_cells;
  for (std::size_t i = 0; i < 8; ++i) {
    for (std::size_t j = 0; i + j < 8; ++j) {
      of_cells.push_back(counts[(i * 8 + j) * 2]);
      if (i + j < 7) of_cells.push_back(counts[(i * 8 + j) * 2 + 1]);
    }
  }
  EXPECT_EQ(of_cells.size(), 64U);
  return test::chi_squared(of_cells);
}

TEST(SampledPoints, AreUniformInATriangle) {
  const std::vector<std::array<Vec3, 3>> triangles{{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}},
                                                   {{{0.1, 0.2, 0.3}, {0.9, 0.3, 0.1}, {0.4, 0.8, 0.7}}},
                                                   {{{0, 0, 0}, {1, 1e-7, 0}, {0.3, 0.3, 1e-9}}},
                                                   {{{5e5, 4.6e6, 120}, {5e5 + 1, 4.6e6, 121}, {5e5, 4.6e6 + 2, 119}}},
                                                   {{{1e-300, 0, 0}, {0, 2e-300, 0}, {0, 0, 3e-300}}},
                                                   {{{1.5e308, 0, 0}, {-1.5e308, 1e308, 0}, {0, -1e308, 1.7e308}}},
                                                   {{{1e200, 1, 0}, {-1e200, 1, 1e-200}, {0, 2, 1e-200}}}};
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto& t = triangles[i];
    const TriangleMesh mesh{{t[0], t[1], t[2]}, {{0, 1, 2}}};
    double largest = 0.0;
    for (const Vec3& v : t) largest = std::max({largest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    std::vector<std::array<double, 3>> weights;
    for (const Vec3& p : drawn(mesh, 4000)) {
      const Place place = place_of(t, p);
      weights.push_back(place.weights);
      // Three products and two sums of coordinates, a rounding each, along three axes.
      ASSERT_LE(place.above, 8 * 0x1p-53 * largest) << i;
    }
    EXPECT_LE(uniformity(weights), 1) << i;
  }
}

TEST(SampledPoints, ControlsOfUniformity) {  // negative controls: the usual mistakes
  test::Random random(3);
  const auto u = [&] { return test::uniform(random, 0, 1); };
  std::vector<std::array<double, 3>> right, without_root, normalised;
  for (int i = 0; i < 4000; ++i) {
    const double root = std::sqrt(u()), second = u(), plain = u(), x = u(), y = u(), z = u();
    right.push_back({1 - root, root * (1 - second), root * second});
    without_root.push_back({1 - plain, plain * (1 - second), plain * second});
    normalised.push_back({x / (x + y + z), y / (x + y + z), z / (x + y + z)});
  }
  EXPECT_LE(uniformity(right), 1);
  EXPECT_GT(uniformity(without_root), 1);
  EXPECT_GT(uniformity(normalised), 1);
}

bool in_box_of(const std::array<Vec3, 3>& t, const Vec3& p) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto [least, most] = std::minmax({t[0][axis], t[1][axis], t[2][axis]});
    if (p[axis] < least || p[axis] > most) return false;
  }
  return true;
}

TEST(SampledPoints, LieOnTheirTriangles) {
  const TriangleMesh mesh = test::assorted_triangles();
  for (const Vec3& p : drawn(mesh, 2000)) {
    bool found = false;
    for (std::size_t i = 0; i < mesh.triangles.size() && !found; ++i) {
      const auto t = corners(mesh, i);
      if (!in_box_of(t, p) || area_of(t) == 0.0) continue;
      const Place place = place_of(t, p);
      // Within 4 u of the coordinates, the largest of which is 5, from the plane; and as much beyond an edge, which for
      // the needle is 1e-6 of its height.
      found = place.above < 4 * 0x1p-53 * 5 && *std::ranges::min_element(place.weights) > -1e-6;
    }
    EXPECT_TRUE(found) << p.x << ' ' << p.y << ' ' << p.z;
  }
}

TEST(SampledPoints, OfFacesAcrossAnAxisLieInThemExactly) {
  const TriangleMesh mesh = test::box_mesh({0.1, 0.2, 0.3}, {0.7, 0.9, 1.1});
  for (const Vec3& p : drawn(mesh, 5000)) {
    EXPECT_TRUE(p.x == 0.1 || p.x == 0.7 || p.y == 0.2 || p.y == 0.9 || p.z == 0.3 || p.z == 1.1);
  }
}

// --- Without area, or next to none ---

TEST(SampledPoints, NeedAnAreaThatIsNotRounding) {
  // On a line through the origin; doubles make a normal of 1e-17 of the differences.
  const Vec3 v{0.1, 0.7, 0.3};
  const TriangleMesh line{{-1.0 * v, {0, 0, 0}, 2.0 * v}, {{0, 1, 2}}};
  EXPECT_FALSE(PointSampler(line, bounding_box(line), {NearSamples{5, 0.0}}, 1).has_needed_area());
}

TEST(SampledPoints, TakeAnyAreaThereIs) {
  // Beside a segment of length 1, whose area would be 0 in units of its square.
  for (const double size : {1e-80, 1e-100, 1e-160, 3e-162, 1e-300, 5e-324}) {
    const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}, {size, 0, 0}, {0, size, 0}}, {{0, 1, 2}, {0, 3, 4}}};
    for (const Vec3& p : drawn(mesh, 200)) {
      EXPECT_TRUE(p.x >= 0 && p.x <= size && p.y >= 0 && p.y <= size) << size;
    }
  }
}

// --- The box ---

TEST(UniformSamples, AreUniformInAnyBox) {
  const TriangleMesh mesh = test::open_box();
  for (const Box& box : {Box{{0, 0, 0}, {1, 1, 1}}, Box{{-1e16, -1, 1e-300}, {1.5, 2, 3e-300}},
                         Box{{-8e307, -1e300, 0}, {8e307, 1e300, 5e-320}},
                         Box{{5e5, 4.6e6, 1}, {5e5 + 1, 4.6e6 + 1, 2}}, Box{{1, 2, 3}, {1, 4, 3}}}) {
    constexpr std::uint64_t kCount = 50000;
    const PointSampler sampler(mesh, box, {UniformSamples{kCount}}, 1);
    ASSERT_TRUE(sampler.is_finite());
    std::vector<Vec3> points(kCount);
    sampler.draw(0, points);
    std::vector<std::size_t> counts(512, 0);
    std::size_t in_use = 1;
    for (const Vec3& p : points) {
      std::size_t cell = 0;
      in_use = 1;
      for (int axis = 0; axis < 3; ++axis) {
        ASSERT_TRUE(p[axis] >= box.lower[axis] && p[axis] <= box.upper[axis]);
        const double side = box.upper[axis] - box.lower[axis];
        if (side == 0) continue;
        cell = cell * 8 + static_cast<std::size_t>(std::min((p[axis] - box.lower[axis]) / side * 8, 7.0));
        in_use *= 8;
      }
      ++counts[cell];
    }
    counts.resize(in_use);
    EXPECT_LE(test::chi_squared(counts), 1) << box.upper.x;
  }
}

// --- Noise ---

TEST(NearSamples, AreMovedByIndependentNormalNoise) {
  const TriangleMesh mesh = test::box_mesh({0, 0, 0}, {3, 4, 12});  // of diagonal 13
  constexpr std::uint64_t kCount = 30000;
  constexpr double kSigma = 0.02;
  std::vector<Vec3> moved(kCount);
  PointSampler(mesh, bounding_box(mesh), {NearSamples{kCount, kSigma}}, 1).draw(0, moved);
  const std::vector<Vec3> still = drawn(mesh, kCount);
  std::array<std::vector<double>, 3> noise;
  std::vector<double> all;
  for (std::size_t i = 0; i < kCount; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      noise[static_cast<std::size_t>(axis)].push_back((moved[i][axis] - still[i][axis]) / (13 * kSigma));
      all.push_back(noise[static_cast<std::size_t>(axis)].back());
    }
  }
  EXPECT_LE(test::kolmogorov_smirnov_of_normal(all), 1);
  for (const std::vector<double>& one : noise) EXPECT_LE(test::kolmogorov_smirnov_of_normal(one), 1);
  for (double& x : all) x *= 1.06;
  EXPECT_GT(test::kolmogorov_smirnov_of_normal(all), 1);  // negative control
  // Mean products of independent numbers: of variance 1 / n.
  const auto correlation = [&](const std::vector<double>& a, const std::vector<double>& b, std::size_t lag) {
    double sum = 0.0;
    for (std::size_t i = lag; i < kCount; ++i) sum += a[i] * b[i - lag];
    return std::abs(sum) / std::sqrt(static_cast<double>(kCount));
  };
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      for (const std::size_t lag : {0U, 1U, 2U}) {
        if (a == b && lag == 0) continue;
        EXPECT_LT(correlation(noise[a], noise[b], lag), 6) << a << b << lag;
      }
    }
  }
}

TEST(NearSamples, AreOnlyDrawnWhereAllOfThemAreFinite) {
  const auto is_finite = [](double size, double sigma) {
    const TriangleMesh mesh{{{-size, -size, -size}, {size, 0, 0}, {0, size, size}}, {{0, 1, 2}}};
    return PointSampler(mesh, {}, {NearSamples{100, sigma}}, 1).is_finite();
  };
  EXPECT_TRUE(is_finite(1, 1));
  EXPECT_TRUE(is_finite(1.7e308, 0));  // the diagonal is not a double
  EXPECT_FALSE(is_finite(1.7e308, 1e-300));
  EXPECT_TRUE(is_finite(4e307, 0.01));
  EXPECT_FALSE(is_finite(4e307, 0.1));
  EXPECT_FALSE(is_finite(1, 1e308));
  const TriangleMesh mesh = test::open_box();
  EXPECT_TRUE(PointSampler(mesh, {{-8e307, 0, 0}, {8e307, 0, 0}}, {UniformSamples{1}}, 1).is_finite());
  EXPECT_FALSE(PointSampler(mesh, {{-1e308, 0, 0}, {1e308, 0, 0}}, {UniformSamples{1}}, 1).is_finite());
}

// --- The same for the same ---

TEST(SampledPoints, DependOnNeitherThreadsNorCounts) {
  const TriangleMesh mesh = test::sphere(9);
  const auto points = [&](std::uint64_t count) {
    const PointSampler sampler(mesh, bounding_box(mesh), {NearSamples{count, 0.1}}, 7);
    std::vector<Vec3> result(count);
    sampler.draw(0, result);
    return result;
  };
  const std::vector<Vec3> expected = points(20000);
  for (const int threads : {1, 2, 7}) {
    const ThreadLimit limit(threads);
    EXPECT_EQ(points(20000), expected);
  }
  for (const std::uint64_t fewer : {1U, 100U, 19999U}) {
    EXPECT_TRUE(std::ranges::equal(points(fewer), std::span(expected).first(fewer)));
  }
}

}  // namespace
}  // namespace raycone
