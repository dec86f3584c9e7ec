#include "core/far/source_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "core/boundary/solid_angles.h"
#include "core/far/far_kernel.h"
#include "core/machine/floating_point.h"
#include "tests/support/differences.h"
#include "tests/support/direct_winding_number.h"
#include "tests/support/expansion_error.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

// Small triangles all over the unit cube.
TriangleMesh small_triangles(test::Random& random, int count, double size) {
  TriangleMesh mesh = test::soup(random, count);
  for (std::size_t i = 0; i < mesh.vertices.size(); i += 3) {
    for (std::size_t k = 1; k < 3; ++k)
      mesh.vertices[i + k] = mesh.vertices[i] + size * (mesh.vertices[i + k] - mesh.vertices[i]);
  }
  return mesh;
}

TriangleMesh mesh_of(std::span<const SolidTriangle> triangles) {
  TriangleMesh mesh;
  for (const SolidTriangle& t : triangles) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {t.a, t.b, t.c});
    mesh.triangles.push_back(t.orientation > 0 ? Triangle{first, first + 1, first + 2}
                                               : Triangle{first, first + 2, first + 1});
  }
  return mesh;
}

Vec3 direction(test::Random& random) {
  for (;;) {
    const Vec3 v = test::uniform_point(random, {{-1, -1, -1}, {1, 1, 1}});
    const double length = std::sqrt(dot(v, v));
    if (length > 0.1 && length < 1) return (1 / length) * v;
  }
}

std::span<const SolidTriangle> triangles_of(const SourceTree& tree, const SourceNode& node) {
  return tree.triangles().subspan(node.begin, node.triangles());
}

SourceTree tree_of(const TriangleMesh& mesh, double tolerance, SourceTree::Detail detail = {}) {
  return {solid_faces(mesh).triangles, tolerance, SimdLevel::kBest, detail};
}

// What blocks and the far field take, and an odd order, for which half as many of Gauss's points, rounded down, would
// be too few.
constexpr std::array<SourceTree::Detail, 3> kDetails{{{16, 16}, {64, kMultipoleOrder}, {8, 5}}};

// The oracle is good to 1e-14.
constexpr double kOracle = 1e-14;

// By how much of its bound an error is off at most.
double check_every_degree(const SourceTree& tree, test::Random& random) {
  const FarKernel kernel = far_kernel(SimdLevel::kBest);
  double closest = 0;  // an error comes to its bound
  for (std::uint32_t number = 0; number < tree.nodes().size(); ++number) {
    const SourceNode& node = tree.nodes()[number];
    const TriangleMesh mesh = mesh_of(triangles_of(tree, node));
    SampleTile samples;
    samples.clear();
    std::vector<double> distances;
    for (const double ratio : {1.1, 1.5, 2.0, 4.0, 8.0, 1e3, 1e9}) {
      distances.push_back(ratio * node.radius);
      samples.add(node.centre + distances.back() * direction(random));
    }
    samples.fill_up();
    for (int p = 1; p <= node.order; ++p) {
      Tile values{};
      kernel.add_multipole(tree, number, p, samples, values);
      for (std::size_t i = 0; i < samples.count; ++i) {
        const double error = std::abs(values[i] - test::direct_winding_number(mesh, samples.query(i)));
        const double bound = test::expansion_error(node, p, distances[i] * (1 - 1e-12));
        EXPECT_LE(error, bound + kOracle) << number << ' ' << p << ' ' << distances[i];
        if (error > 1e-10) closest = std::max(closest, error / bound);
      }
    }
  }
  return closest;
}

TEST(SourceTree, EveryDegreeErrsByNoMoreThanItsBound) {
  const DefaultFloatingPoint guard;
  for (const SourceTree::Detail& detail : kDetails) {
    test::Random random(1);
    const SourceTree tree = tree_of(small_triangles(random, 200, 0.05), 1e-10, detail);
    EXPECT_EQ(tree.nodes().front().order, detail.order);
    EXPECT_GT(check_every_degree(tree, random), 0.1) << detail.order;  // or the bounds would be of little use
  }
}

constexpr MultipoleBall kUnitBall{{}, 1.0, 1.0};

// A small triangle at (1, 0, 0) from the centre that faces it: the potential of degree n is n P_n(x / r) A / 4 pi r^(n
// + 1), and nowhere larger than on the x axis.
TEST(SourceTree, BoundsOfADipoleAreThoseOfItsPotential) {
  const double size = 1e-4;  // so much, relative, is what it differs from a dipole by
  const SolidTriangle t = solid_faces({{{1, 0, 0}, {1, size, 0}, {1, 0, size}}, {{0, 1, 2}}}).triangles.front();
  const Multipole multipole = multipole_of({&t, 1}, kUnitBall, kMultipoleOrder, 0);
  const MultipoleBounds bounds = bounds_of(multipole);
  const double area = size * size / 2;
  for (int n = kMultipoleOrder; n >= 1; --n) {
    const double expected = n * area / (4 * std::numbers::pi);
    EXPECT_NEAR(bounds.size[static_cast<std::size_t>(n)] / expected, 1, 20 * n * size) << n;
    // Some u times what recurrences may grow by, a factor of 1 + sqrt(2) a degree.
    EXPECT_LT(bounds.evaluation[static_cast<std::size_t>(n)], 1e-18 * std::pow(2.5, n)) << n;
  }
  const double rho = 0.5;
  for (const int order : {kMultipoleOrder, 5}) {
    double sum = 0;
    for (int n = order + 1; n < 200; ++n) sum += n * area / (4 * std::numbers::pi) * std::pow(rho, n + 1);
    EXPECT_NEAR(beyond_multipoles(area, 1, order, rho) / sum, 1, 1e-9);  // a sum of 200 roundings
  }
}

// How far degrees are apart at most, as parts of what both may be off by.
double largest_part_of_error(const Multipole& a, const Multipole& b) {
  double largest = 0;
  for (int n = 1; n <= std::min(a.order, b.order); ++n) {
    Multipole difference;
    for (int m = 0; m <= n; ++m) {
      const std::size_t term = multipole_index(n, m);
      difference.re[term] = a.re[term] - b.re[term];
      difference.im[term] = a.im[term] - b.im[term];
    }
    const auto i = static_cast<std::size_t>(n);
    largest = std::max(largest, bounds_of(difference).size[i] / (a.error[i] + b.error[i]));
  }
  return largest;
}

TEST(SourceTree, ShiftedExpansionsAreThoseAboutTheOtherCentre) {
  test::Random random(2);
  const auto all = solid_faces(small_triangles(random, 12, 0.2)).triangles;
  const Vec3 from{0.5, 0.4, 0.6}, to{0.25, 0.5, 0.5};
  for (const int order : {16, kMultipoleOrder, 5}) {
    const Multipole there = multipole_of(all, {to, 4.0, 0.6}, order, 0);
    Multipole shifted{order, {}, {}, {}};
    add_shifted(shifted, multipole_of(all, {from, 2.0, 0.9}, order, 0), 0.25 * (from - to), 0.5);
    EXPECT_LE(largest_part_of_error(there, shifted), 1) << order;
    EXPECT_LT(*std::ranges::max_element(shifted.error), 1e-13) << order;  // some u times what recurrences may grow by
  }
}

// Those of a lower order are those of a higher one, as far as they go: an integral that is exact is the same by any
// rule but for rounding.
TEST(SourceTree, MomentsDoNotDependOnTheOrder) {
  test::Random random(7);
  const auto all = solid_faces(small_triangles(random, 12, 0.9)).triangles;
  const MultipoleBall ball{{0.5, 0.5, 0.5}, 1.0, 1.0};
  const Multipole high = multipole_of(all, ball, kMultipoleOrder, 0);
  for (int order = 1; order < kMultipoleOrder; ++order) {
    const Multipole low = multipole_of(all, ball, order, 0);
    EXPECT_LE(largest_part_of_error(low, high), 1) << order;
  }
}

// One edge next to the border of the ball, across it or along it, is the worst that there is.
TEST(SourceTree, MomentsByFewPointsErrByNoMoreThanTheirBound) {
  for (const double size : {0.1, 0.3, 0.6}) {
    const TriangleMesh mesh{{{0.9, 0, 0.2}, {0.9, size, 0.2}, {0.9 - size, 0, 0.2}}, {{0, 1, 2}}};
    const auto one = solid_faces(mesh).triangles;
    const Multipole exact = multipole_of(one, kUnitBall, kMultipoleOrder, 0);
    double closest = 0;  // an error comes to its bound
    for (const double precision : {1e-2, 1e-5, 1e-8, 1e-11}) {
      const double part = largest_part_of_error(multipole_of(one, kUnitBall, kMultipoleOrder, precision), exact);
      EXPECT_LE(part, 1) << size << ' ' << precision;
      closest = std::max(closest, part);
    }
    EXPECT_GT(closest, 1e-2) << size;  // or the bounds would be of little use
  }
}

TEST(SourceTree, MomentsAndShiftsAreTheSameForEverySimdLevel) {
  const DefaultFloatingPoint guard;
  test::Random random(4);
  for (const int count : {1, 2, 3, 7, 8, 9}) {
    const auto all = solid_faces(small_triangles(random, count, 0.3)).triangles;
    for (const int order : {16, kMultipoleOrder, 5}) {
      const auto moments = [&](SimdLevel level) {
        const MomentKernel kernel = moment_kernel(level);
        const Multipole here = multipole_of(all, {{0.5, 0.5, 0.5}, 1.0, 1.0}, order, 0, kernel);
        Multipole sum = here;
        add_shifted(sum, here, {0.3, -0.2, 0.4}, 0.5, kernel);
        return sum;
      };
      const Multipole best = moments(SimdLevel::kBest);
      for (const SimdLevel level : {SimdLevel::kSse4, SimdLevel::kAvx2, SimdLevel::kAvx512}) {
        const Multipole here = moments(level);
        EXPECT_EQ(here.re, best.re) << count << ' ' << order;
        EXPECT_EQ(here.im, best.im) << count << ' ' << order;
      }
    }
  }
}

TEST(SourceTree, HoldsEachTriangleInEveryNodeAbove) {
  test::Random random(3);
  TriangleMesh mesh = test::joined(small_triangles(random, 300, 0.02), test::soup(random, 20));
  const SourceTree tree = tree_of(mesh, 1e-10);
  ASSERT_EQ(tree.nodes().front().next, tree.nodes().size());
  for (std::uint32_t number = 0; number < tree.nodes().size(); ++number) {
    const SourceNode& node = tree.nodes()[number];
    double twice_area = 0.0;
    for (const SolidTriangle& t : triangles_of(tree, node)) {
      const Vec3 normal = cross(t.b - t.a, t.c - t.a);
      twice_area += std::sqrt(dot(normal, normal));
      for (const Vec3& v : {t.a, t.b, t.c}) {
        const Vec3 y = v - node.centre;
        EXPECT_LE(std::sqrt(dot(y, y)), node.radius);
      }
    }
    EXPECT_LE(twice_area / 2, node.area);
    std::uint32_t covered = node.own_end;
    for (std::uint32_t child = number + 1; child < node.next; child = tree.nodes()[child].next) {
      EXPECT_EQ(tree.nodes()[child].begin, covered);
      covered = tree.nodes()[child].end;
    }
    EXPECT_EQ(covered, node.end);
  }
}

// Near and far together keep the tolerance, at points as near to triangles as they come.
TEST(SourceTree, SumsKeepTheTolerance) {
  const DefaultFloatingPoint guard;
  test::Random random(4);
  const TriangleMesh mesh = small_triangles(random, 3000, 0.02);
  SampleTile samples;
  samples.clear();
  while (samples.count < 51) samples.add(test::uniform_point(random, {{-0.2, -0.2, -0.2}, {1.2, 1.2, 1.2}}));
  samples.fill_up();
  std::vector<double> expected;
  for (std::size_t i = 0; i < samples.count; ++i) {
    expected.push_back(test::direct_winding_number(mesh, samples.query(i)));
  }
  for (const double tolerance : {1e-4, 1e-7, 1e-10}) {
    for (const SourceTree::Detail& detail : kDetails) {
      const SourceTree tree = tree_of(mesh, tolerance, detail);
      FarTile result;
      far_kernel(SimdLevel::kBest).sum(tree, samples, result);
      double largest = 0;
      for (std::size_t i = 0; i < samples.count; ++i) {
        const double w = static_cast<double>(result.near.turns(i)) + result.near.argument[i] + result.far[i];
        largest = test::larger_difference(largest, std::abs(w - expected[i]));
      }
      EXPECT_LE(largest, tolerance) << detail.order;
      if (detail.order < 16 && tolerance < 1e-4) continue;  // too little is far
      EXPECT_GT(largest, tolerance * 1e-6) << detail.order;
      // Most of the 51 * 3000 pairs are far.
      EXPECT_LT(result.near_terms, 51U * 1500U) << detail.order;
      EXPECT_GT(result.far_terms, 51U * 10U) << detail.order;
    }
  }
}

// Samples on triangles, at their corners and on their sides, are ties: there the exactness rules decide, as in a sum
// over all triangles, which looks at each factor. All samples of a tile lie on one triangle, so that whole groups are
// next to it.
TEST(SourceTree, DecidesTiesOnTrianglesAsASumOverAllDoes) {
  const DefaultFloatingPoint guard;
  test::Random random(6);
  const SourceTree tree = tree_of(small_triangles(random, 300, 0.3), 1e-10, kDetails[1]);
  const auto value = [](const ProductTile& products, std::size_t i) {
    return static_cast<double>(products.turns(i)) + products.argument[i];
  };
  for (std::size_t n = 0; n < 40; ++n) {
    const SolidTriangle& t = tree.triangles()[n];
    SampleTile samples;
    samples.clear();
    for (const auto& [p, q] : {std::pair(t.a, t.b), std::pair(t.b, t.c), std::pair(t.c, t.a)}) {
      for (const double at : {0.0, 0.25, 0.5, 0.75}) samples.add(p + at * (q - p));
    }
    samples.fill_up();
    FarTile result;
    far_kernel(SimdLevel::kBest).sum(tree, samples, result);
    ProductTile all;
    solid_angle_kernel(SimdLevel::kBest)(tree.triangles(), samples, all);
    // 1e-10 is the tolerance; 300 factors round by less.
    for (std::size_t i = 0; i < samples.count; ++i)
      EXPECT_NEAR(value(result.near, i) + result.far[i], value(all, i), 2e-10);
  }
}

// It has no coefficients to be read, not even where the square of the distance is infinite.
TEST(SourceTree, ANodeWithoutExpansionIsNeverFar) {
  const DefaultFloatingPoint guard;
  test::Random random(8);
  const SourceTree tree = tree_of(small_triangles(random, 1, 0.3), 1e-6, kDetails[1]);
  ASSERT_EQ(tree.nodes().front().order, 0);
  for (const double distance : {2.0, 1e100, 1e200, 1e300}) {
    SampleTile samples;
    samples.clear();
    samples.add({distance, 0.1, 0.2});
    samples.fill_up();
    for (const SimdLevel level : {SimdLevel::kSse4, SimdLevel::kAvx2, SimdLevel::kAvx512}) {
      FarTile result;
      far_kernel(level).sum(tree, samples, result);
      EXPECT_EQ(result.far_terms, 0U) << distance;
      EXPECT_EQ(result.near_terms, 1U) << distance;
    }
  }
}

TEST(SourceTree, SumsAreTheSameAtEverySimdLevelAndInAnyTile) {
  const DefaultFloatingPoint guard;
  test::Random random(5);
  const SourceTree tree = tree_of(small_triangles(random, 1000, 0.05), 1e-10, kDetails[1]);
  SampleTile samples;
  samples.clear();
  while (samples.count < kTile) samples.add(test::uniform_point(random, {{-1, -1, -1}, {2, 2, 2}}));
  const auto values_of = [&](const SampleTile& some, SimdLevel level) {
    SampleTile tile = some;
    FarTile result;
    tile.fill_up();
    far_kernel(level).sum(tree, tile, result);
    std::vector<double> values;
    for (std::size_t i = 0; i < tile.count; ++i) {
      values.insert(values.end(), {static_cast<double>(result.near.turns(i)), result.near.argument[i], result.far[i]});
    }
    return std::pair(values, std::pair(result.near_terms, result.far_terms));
  };
  const auto expected = values_of(samples, SimdLevel::kBest);
  for (const SimdLevel level : {SimdLevel::kSse4, SimdLevel::kAvx2, SimdLevel::kAvx512}) {
    if (!is_available(level)) continue;
    EXPECT_EQ(values_of(samples, level), expected);
  }
  std::vector<double> alone;
  for (std::size_t i = 0; i < kTile; ++i) {
    SampleTile one;
    one.clear();
    one.add(samples.query(i));
    const auto values = values_of(one, SimdLevel::kBest).first;
    alone.insert(alone.end(), values.begin(), values.end());
  }
  EXPECT_EQ(alone, expected.first);
}

}  // namespace
}  // namespace raycone
