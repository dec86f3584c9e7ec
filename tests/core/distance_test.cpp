// Distances on lattices and at points, against the oracle and each other.
#include "core/distance/distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/data/distance_blocks.h"
#include "core/distance/triangle_distance.h"
#include "core/exact/direct_distance.h"
#include "tests/support/lattice_samples.h"
#include "tests/support/shapes.h"
#include "tests/support/values.h"

namespace raycone {
namespace {

using test::samples_of;

Lattice unit_lattice(std::int64_t samples) {
  const double spacing = 1.0 / static_cast<double>(samples - 1);
  return {{0, 0, 0}, {spacing, spacing, spacing}, {-2, -2, -2}, {samples + 4, samples + 4, samples + 4}};
}

std::vector<double> band_of(const DistanceEvaluator& distance, const Lattice& lattice, const LatticeBlock& block,
                            double band) {
  std::vector<double> distances(static_cast<std::size_t>(block.size()));
  distance.evaluate(lattice, block, band, distances);
  return distances;
}

TEST(Distance, OfPointsIsThatOfTheOracle) {
  const TriangleMesh mesh = test::assorted_triangles();
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  std::vector<Vec3> points;
  for (int n = 0; n < 3000; ++n) points.push_back({normal(random), normal(random), normal(random)});
  const std::vector<double> distances = test::values_of(DistanceEvaluator(mesh), points);
  for (std::size_t n = 0; n < points.size(); ++n) {
    // Some dozens of roundings of numbers below 10.
    EXPECT_NEAR(distances[n], static_cast<double>(direct_distance(mesh, points[n])), 1e-13);
  }
}

// As many needles of a cone of so many segments, at most.
TriangleMesh needles_of_cone(std::uint32_t segments) {
  constexpr std::uint32_t kNeedles = 1500;
  TriangleMesh mesh{{{0.1, 0.2, 0.9}}, {}};
  for (std::uint32_t n = 0; n <= std::min(kNeedles, segments); ++n) {
    const double angle = 6.283185307179586 * n / segments;
    mesh.vertices.push_back({std::cos(angle), std::sin(angle), 0.1 * std::sin(3 * angle)});
    if (n > 0) mesh.triangles.push_back({0, n, n + 1});
  }
  return mesh;
}

double least_of_all(const TriangleMesh& mesh, const Vec3& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const Triangle& t : mesh.triangles) {
    const TriangleDistance triangle(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
    least = std::min(least, triangle.squared(p));
  }
  return std::sqrt(least);
}

TEST(Distance, OfPointsWithinALimitIsWhatItIsWithout) {
  const TriangleMesh mesh = test::assorted_triangles();
  const DistanceEvaluator distance(mesh);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<Vec3> points;
  for (int n = 0; n < 1000; ++n) points.push_back({normal(random), normal(random), normal(random)});
  const std::vector<double> distances = test::values_of(distance, points);
  for (const double limit : {0.0, 1e-200, 0.1, distances[0], std::nextafter(distances[0], 0.0), 1.0, 100.0}) {
    std::vector<double> limited(points.size());
    distance.evaluate(points, limited, limit);
    for (std::size_t n = 0; n < points.size(); ++n) {
      if (distances[n] <= limit) {
        EXPECT_EQ(limited[n], distances[n]);
      } else {
        EXPECT_GT(limited[n], limit);
      }
    }
  }
}

// Of needles of all thicknesses: next to them, nearly all squares are in doubt until the nearest is known.
TEST(Distance, OfPointsNextToNeedlesIsTheLeastOfAll) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (const std::uint32_t segments : {60U, 3000U, 40000U, 500000U}) {
    const TriangleMesh mesh = needles_of_cone(segments);
    std::vector<Vec3> points;
    for (int n = 0; n < 200; ++n) {
      const Triangle& t = mesh.triangles[random() % mesh.triangles.size()];
      const double v = std::abs(uniform(random)), w = std::abs(uniform(random)) * (1 - v);
      const Vec3& a = mesh.vertices[t[0]];
      const Vec3 on = a + v * (mesh.vertices[t[1]] - a) + w * (mesh.vertices[t[2]] - a);
      const double off = std::pow(10.0, 8 * uniform(random) - 8);
      points.push_back(on + off * Vec3{uniform(random), uniform(random), uniform(random)});
    }
    const std::vector<double> distances = test::values_of(DistanceEvaluator(mesh), points);
    for (std::size_t n = 0; n < points.size(); ++n)
      EXPECT_EQ(distances[n], least_of_all(mesh, points[n])) << segments << " segments, point " << n;
  }
}

// On a lattice many triangles are equally near.
TEST(Distance, NearestTriangleIsTheFirstOfThoseAtTheLeastDistance) {
  test::Random random(6);
  for (const int triangles : {7, 60, 1000}) {
    const TriangleMesh mesh = test::lattice_soup(random, triangles, 3);
    std::vector<Vec3> points;
    for (int n = 0; n < 200; ++n) points.push_back(test::uniform_point(random, {{-1, -1, -1}, {4, 4, 4}}));
    for (int n = 0; n < 50; ++n) points.push_back(points[static_cast<std::size_t>(n)]), points.back().x = 1.5;
    std::vector<std::uint32_t> nearest(points.size());
    DistanceEvaluator(mesh).find_nearest(points, nearest);
    for (std::size_t n = 0; n < points.size(); ++n) {
      std::vector<double> squares;
      for (const Triangle& t : mesh.triangles) {
        const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
        squares.push_back(TriangleDistance(0.25 * a, 0.25 * b, 0.25 * c).squared(0.25 * points[n]));
      }
      ASSERT_EQ(nearest[n], std::ranges::min_element(squares) - squares.begin()) << triangles << ' ' << n;
    }
  }
}

// Many points are put in another order, some 2^20 at a time.
TEST(Distance, OfManyPointsIsThatOfFew) {
  const TriangleMesh mesh = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const DistanceEvaluator distance(mesh);
  test::Random random(8);
  std::vector<Vec3> points{{1e300, -1e300, 0}, {0, 1e-300, 0}};
  while (points.size() < (std::size_t{1} << 20) + 5000) {
    points.push_back(test::uniform_point(random, {{-1, -1, -1}, {2, 2, 2}}));
  }
  const std::vector<double> distances = test::values_of(distance, points);
  std::vector<std::uint32_t> nearest(points.size());
  distance.find_nearest(points, nearest);
  constexpr std::size_t kFew = 100, kLeft = 37;  // of so many hundreds
  for (std::size_t begin = 0; begin < points.size(); begin += kLeft * kFew) {
    const std::vector<Vec3> few(points.begin() + static_cast<std::ptrdiff_t>(begin),
                                points.begin() + static_cast<std::ptrdiff_t>(std::min(begin + kFew, points.size())));
    const std::vector<double> expected = test::values_of(distance, few);
    std::vector<std::uint32_t> triangles(few.size());
    distance.find_nearest(few, triangles);
    for (std::size_t n = 0; n < few.size(); ++n) {
      ASSERT_EQ(distances[begin + n], expected[n]) << begin + n;
      ASSERT_EQ(nearest[begin + n], triangles[n]) << begin + n;
    }
  }
}

// Such needles have no direction that could be trusted. With one triangle beside them that has.
TEST(Distance, OfSamplesNextToNeedlesIsThatOfPoints) {
  const Lattice lattice{{0.05, -0.1, 0.0}, {0.05, 0.04, 0.045}, {-4, -4, -4}, {23, 20, 25}};
  const std::vector<Vec3> points = samples_of(lattice);
  for (const std::uint32_t segments : {60U, 3000U, 40000U, 500000U}) {
    TriangleMesh mesh = needles_of_cone(segments);
    for (const bool with_another : {false, true}) {
      if (with_another) {
        test::add_triangle(mesh, {0.3, 0.1, 0.1}, {0.5, 0.2, 0.3}, {0.4, 0.5, 0.2});
      }
      const DistanceEvaluator distance(mesh);
      const std::vector<double> expected = test::values_of(distance, points);
      for (const double band : {0.05, 10.0}) {
        const std::vector<double> distances = band_of(distance, lattice, whole(lattice), band);
        std::size_t within = 0;
        for (std::size_t n = 0; n < points.size(); ++n) {
          ASSERT_EQ(distances[n], std::min(expected[n], band)) << segments << " segments, sample " << n;
          within += expected[n] < band ? 1 : 0;
        }
        EXPECT_GT(within, 100U);
      }
    }
  }
}

TEST(Distance, OfSamplesIsThatOfTheOracleInTheBand) {
  const TriangleMesh mesh = test::assorted_triangles();
  const Lattice lattice = unit_lattice(14);
  for (const double voxels : {0.5, 1.0, 3.0, 100.0}) {
    const double band = voxels * lattice.spacing.x;
    const std::vector<double> distances = band_of(DistanceEvaluator(mesh), lattice, whole(lattice), band);
    const std::vector<Vec3> points = samples_of(lattice);
    for (std::size_t n = 0; n < points.size(); ++n) {
      const double expected = static_cast<double>(direct_distance(mesh, points[n]));
      ASSERT_NEAR(distances[n], std::min(expected, band), 1e-13) << voxels << ' ' << n;
    }
  }
}

// Both take the least of the same numbers.
TEST(Distance, OfSamplesAndPointsAgreeBitByBit) {
  for (const TriangleMesh& mesh :
       {test::assorted_triangles(), test::box_mesh({0.25, 0.25, 0.25}, {0.75, 0.75, 0.75})}) {
    const DistanceEvaluator distance(mesh);
    const Lattice lattice = unit_lattice(40);
    const double band = 2.5 * lattice.spacing.x;
    const std::vector<double> samples = band_of(distance, lattice, whole(lattice), band);
    const std::vector<double> points = test::values_of(distance, samples_of(lattice));
    std::size_t in_band = 0;
    for (std::size_t n = 0; n < samples.size(); ++n) {
      ASSERT_EQ(samples[n], std::min(points[n], band)) << n;
      in_band += samples[n] < band ? 1 : 0;
    }
    EXPECT_GT(in_band, samples.size() / 20);
    EXPECT_LT(in_band, samples.size());
  }
}

// A cube of the given corners with `cells` x `cells` squares of two triangles on each side.
TriangleMesh fine_cube(double lower, double upper, int cells) {
  TriangleMesh mesh;
  const auto vertex = [&](int axis, double level, int i, int j) {
    const auto at = [&](int n) { return n == cells ? upper : lower + n * ((upper - lower) / cells); };
    Vec3 v;
    v[axis] = level;
    v[(axis + 1) % 3] = at(i);
    v[(axis + 2) % 3] = at(j);
    mesh.vertices.push_back(v);
    return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const double level : {lower, upper}) {
      for (int i = 0; i < cells; ++i) {
        for (int j = 0; j < cells; ++j) {
          const auto a = vertex(axis, level, i, j), b = vertex(axis, level, i + 1, j);
          const auto c = vertex(axis, level, i + 1, j + 1), d = vertex(axis, level, i, j + 1);
          mesh.triangles.push_back({a, b, c});
          mesh.triangles.push_back({a, c, d});
        }
      }
    }
  }
  return mesh;
}

// The samples of the lattice are the points' to the bit, whatever the band. Returns how many lie on the surface.
int expect_points_bit_by_bit(const TriangleMesh& mesh, const Lattice& lattice) {
  const DistanceEvaluator distance(mesh);
  const std::vector<double> points = test::values_of(distance, samples_of(lattice));
  for (const double voxels : {1e-30, 0.5, 1.0, 3.0, 1e30}) {
    const double band = voxels * lattice.spacing.x;
    const std::vector<double> samples = band_of(distance, lattice, whole(lattice), band);
    for (std::size_t n = 0; n < samples.size(); ++n) {
      EXPECT_EQ(samples[n], std::min(points[n], band)) << "sample " << n << " of " << samples.size();
      if (samples[n] != std::min(points[n], band)) return 0;
    }
  }
  return static_cast<int>(std::ranges::count(points, 0.0));
}

// Blocks are halved at every remainder, and their middles are samples on faces, edges and vertices.
TEST(Distance, OfSamplesOnTheSurfaceOfFineMeshes) {
  const TriangleMesh mesh = fine_cube(0, 1, 16);
  int on_surface = 0;
  for (std::int64_t n = 9; n <= 24; ++n) {
    const double spacing = n % 2 == 0 ? 1.0 / 8 : 1.0 / 12;  // through the vertices of the mesh, or beside them
    on_surface +=
        expect_points_bit_by_bit(mesh, {{0, 0, 0}, {spacing, spacing, spacing}, {-3, -n / 2, 1}, {n, n, n / 2}});
    on_surface +=
        expect_points_bit_by_bit(mesh, {{0, 0, 0}, {spacing, spacing, spacing}, {0, 0, 0}, {n % 8 + 1, n, 1}});
  }
  EXPECT_GT(on_surface, 3000);
}

// The example of issue 13.
TEST(Distance, OfTheSidesOfACubeIsZero) {
  const DistanceEvaluator distance(fine_cube(0, 1, 64));
  const double h = 1.0 / 45;
  const Lattice lattice{{0, 0, 0}, {h, h, h}, {-4, -4, -4}, {54, 54, 54}};
  const std::vector<double> distances = band_of(distance, lattice, whole(lattice), 3 * h);
  const std::vector<Vec3> points = samples_of(lattice);
  int on_sides = 0;
  for (std::size_t n = 0; n < points.size(); ++n) {
    const auto [least, most] = std::minmax({points[n].x, points[n].y, points[n].z});
    if (least < 0 || most > 1 || (least > 0 && most < 1)) continue;
    ASSERT_EQ(distances[n], 0) << n;
    ++on_sides;
  }
  EXPECT_GT(on_sides, 6 * 44 * 44);
}

// The mesh is a speck in the middle of the lattice, or lies beyond its last sample.
TEST(Distance, OfSamplesFarAway) {
  const double kEverywhere = std::numeric_limits<double>::infinity();
  const TriangleMesh cube = test::box_mesh({0, 0, 0}, {1, 1, 1});
  for (const double size : {1e-290, 1e-150, 1.0, 1e150}) {
    const TriangleMesh mesh = test::moved(cube, {size, size, size}, {});
    for (const double reach : {1e3, 3e15, 3.5e16, 7e16, 1e20, 1e100, 1e150}) {
      const double h = reach * size;
      for (const std::int64_t first : {-1, 0, 1}) {
        const Lattice lattice{{0, 0, 0}, {h, h, h}, {first, -1, -1}, {3, 3, 3}};
        expect_points_bit_by_bit(mesh, lattice);
        const std::vector<double> distances = band_of(DistanceEvaluator(mesh), lattice, whole(lattice), kEverywhere);
        const std::vector<Vec3> points = samples_of(lattice);
        for (std::size_t n = 0; n < points.size(); ++n) {
          const double expected = static_cast<double>(direct_distance(mesh, points[n]));
          ASSERT_LE(std::abs(distances[n] - expected), 1e-12 * expected) << size << ' ' << reach << ' ' << n;
        }
      }
    }
  }
}

TEST(Distance, IsCutOffAtTheBandFarAway) {
  const DistanceEvaluator distance(test::box_mesh({0, 0, 0}, {1, 1, 1}));
  const Lattice lattice{{0, 0, 0}, {1e20, 1e20, 1e20}, {-1, -1, -1}, {3, 3, 3}};
  const std::vector<double> distances = band_of(distance, lattice, whole(lattice), 1.5e20);
  EXPECT_EQ(distances[0], 1.5e20) << "a corner of the lattice, at 1.73e20";
  EXPECT_DOUBLE_EQ(distances[1], std::sqrt(2.0) * 1e20);
  EXPECT_EQ(distances[13], 0);
  EXPECT_EQ(distances[14], 1e20);
}

// The nearest point of all triangles is one corner of their boxes. Each finds its own distance to it, next to what is
// rounded; of these the least counts, also where it is below that of the boxes, which is rounded less.
TEST(Distance, OfSamplesNextToACornerOfManyTriangles) {
  test::Random random(1);
  TriangleMesh mesh{{{0, 0, 0}}, {}};
  for (int n = 0; n < 512; ++n) {
    mesh.vertices.push_back(test::uniform_point(random, {{-0.25, -0.25, -0.25}, {0, 0, 0}}));
    mesh.vertices.push_back(test::uniform_point(random, {{-0.25, -0.25, -0.25}, {0, 0, 0}}));
    const auto last = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
    mesh.triangles.push_back({last - 1, 0, last});
  }
  mesh.vertices.push_back({-1, -1, -1});  // where scaling looks
  const auto far = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  mesh.triangles.push_back({far, far, far});
  for (const double h : {1e-3, 1e-5, 1e-7, 1e-9}) {
    expect_points_bit_by_bit(mesh, {{0, 0, 0}, {h, h, h}, {1, 1, 1}, {9, 9, 9}});
  }
}

TEST(Distance, ToTheOriginAlone) {
  const TriangleMesh origin{{{0, 0, 0}}, {{0, 0, 0}}};
  for (const double size : {1e-300, 1e-200, 1.0, 1e300}) {
    EXPECT_DOUBLE_EQ(test::values_of(DistanceEvaluator(origin), std::vector<Vec3>{{3 * size, 4 * size, 0}})[0],
                     5 * size);
    expect_points_bit_by_bit(origin, {{0, 0, 0}, {size, size, size}, {-1, -1, -1}, {3, 3, 3}});
  }
}

TEST(Distance, OfNoSamplesIsNothing) {
  const DistanceEvaluator distance(test::box_mesh({0, 0, 0}, {1, 1, 1}));
  const Lattice lattice = unit_lattice(4);
  std::vector<double> none;
  distance.evaluate(lattice, {{0, 0, 0}, {0, 3, 3}}, 1.0, none);
  distance.evaluate(std::vector<Vec3>{}, none);
  EXPECT_TRUE(none.empty());
  for (const std::int64_t first : {0, 1, 7}) {
    DistanceBlocks blocks;
    distance.evaluate(lattice, {{first, 0, 0}, {0, 3, 3}}, 1.0, blocks);
    EXPECT_EQ(blocks.blocks().size(), 0) << first;
  }
}

TEST(Distance, DoesNotDependOnTheBlock) {
  const DistanceEvaluator distance(test::assorted_triangles());
  const Lattice lattice = unit_lattice(30);
  const double band = 3 * lattice.spacing.x;
  for (const int axis : {0, 2}) {
    LatticeBlock layer = whole(lattice);
    const auto a = static_cast<std::size_t>(axis);
    layer.first[a] = 7;
    layer.counts[a] = 1;
    const std::vector<double> alone = band_of(distance, lattice, layer, band);
    const std::vector<double> all = test::values_of(distance, samples_of(lattice, layer));
    for (std::size_t n = 0; n < alone.size(); ++n) ASSERT_EQ(alone[n], std::min(all[n], band));
  }
}

// Numbers of all samples, and of no block that is beyond the band.
void expect_alike(const DistanceEvaluator& distance, const Lattice& lattice, const LatticeBlock& block, double band) {
  DistanceBlocks blocks;
  blocks.reset({{7, 7, 7}, {30, 1, 30}}, 0.0);  // of another one, before
  std::ranges::fill(blocks.add({1, 0, 1}), 0.0);
  distance.evaluate(lattice, block, band, blocks);
  const std::vector<double> dense = band_of(distance, lattice, block, band);
  std::size_t n = 0;
  for_each_sample(block, [&](const LatticeIndex& index) {
    ASSERT_EQ(blocks.at(index), dense[n++]) << index[0] << ' ' << index[1] << ' ' << index[2];
  });
  for_each_sample(blocks.blocks(), [&](const LatticeIndex& place) {
    const std::span<const double> numbers = blocks.numbers(place);
    EXPECT_TRUE(numbers.empty() || std::ranges::min(numbers) < band);
  });
}

TEST(Distance, InBlocksIsThatOfTheSamples) {
  const DistanceEvaluator distance(test::assorted_triangles());
  for (const std::int64_t first : {-13, -8, 0, 5}) {
    const Lattice lattice{{-0.1, -0.2, 0.05}, {0.04, 0.04, 0.04}, {first, first + 3, first - 1}, {41, 35, 38}};
    for (const double band : {0.01, 0.12, 0.5, 100.0}) {
      expect_alike(distance, lattice, whole(lattice), band);
      expect_alike(distance, lattice, {{first + 2, first + 9, first + 20}, {17, 1, 3}}, band);
    }
  }
}

TEST(Distance, InBlocksOfRareLattices) {
  const DistanceEvaluator distance(test::assorted_triangles());
  const Lattice huge{{-1e17, 0, 0}, {5e15, 5e15, 5e15}, {0, 0, 0}, {41, 9, 3}};  // some samples are far
  for (const double band : {1.0, 2e16, 1e300}) expect_alike(distance, huge, whole(huge), band);
  const Lattice one{{0.2, 0.3, 0.4}, {1, 1, 1}};
  expect_alike(distance, one, whole(one), 3.0);
  expect_alike(DistanceEvaluator(TriangleMesh{}), one, whole(one), 3.0);
  const DistanceEvaluator origin({{{0, 0, 0}}, {{0, 0, 0}}});
  expect_alike(origin, unit_lattice(10), whole(unit_lattice(10)), 0.3);
}

TEST(Distance, ScalesWithTheMesh) {
  const TriangleMesh mesh = test::assorted_triangles();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-1, 2);
  std::vector<Vec3> points;
  for (int n = 0; n < 100; ++n) points.push_back({number(random), number(random), number(random)});
  const std::vector<double> expected = test::values_of(DistanceEvaluator(mesh), points);
  for (const int exponent : {-900, -3, 3, 1000}) {
    TriangleMesh scaled_mesh = mesh;
    std::vector<Vec3> scaled_points = points;
    for (auto* const vertices : {&scaled_mesh.vertices, &scaled_points}) {
      for (Vec3& p : *vertices) p = {std::ldexp(p.x, exponent), std::ldexp(p.y, exponent), std::ldexp(p.z, exponent)};
    }
    const std::vector<double> actual = test::values_of(DistanceEvaluator(scaled_mesh), scaled_points);
    for (std::size_t n = 0; n < points.size(); ++n) EXPECT_EQ(actual[n], std::ldexp(expected[n], exponent));
  }
}

TEST(Distance, HoldsFarAway) {
  const DistanceEvaluator distance(test::box_mesh({0, 0, 0}, {1, 1, 1}));
  const double largest = std::numeric_limits<double>::max();
  const std::vector<Vec3> points{{1e6, 0, 0}, {3e20, 4e20, 0}, {0, 0, -1e300}, {largest, largest, largest}};
  const std::vector<double> distances = test::values_of(distance, points);
  EXPECT_EQ(distances[0], 1e6 - 1);
  EXPECT_DOUBLE_EQ(distances[1], 5e20);
  EXPECT_DOUBLE_EQ(distances[2], 1e300);
  EXPECT_EQ(distances[3], largest) << "as large as doubles get";
  const DistanceEvaluator from_speck(test::box_mesh({0, 0, 0}, {1e-300, 1e-300, 1e-300}));
  EXPECT_DOUBLE_EQ(test::values_of(from_speck, std::vector<Vec3>{{3e-200, 4e-200, 0}})[0], 5e-200);
  EXPECT_DOUBLE_EQ(test::values_of(from_speck, std::vector<Vec3>{{0, 3e200, 4e200}})[0], 5e200);
}

}  // namespace
}  // namespace raycone
