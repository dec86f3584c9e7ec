// Distances on lattices and at points, against the oracle and each other.
#include "core/distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/direct_distance.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

Lattice unit_lattice(std::int64_t samples) {
  const double spacing = 1.0 / static_cast<double>(samples - 1);
  return {{0, 0, 0}, {spacing, spacing, spacing}, {-2, -2, -2}, {samples + 4, samples + 4, samples + 4}};
}

std::vector<Vec3> samples_of(const Lattice& lattice, const LatticeBlock& block) {
  std::vector<Vec3> points;
  for (std::int64_t k = block.first[2]; k < block.first[2] + block.counts[2]; ++k) {
    for (std::int64_t j = block.first[1]; j < block.first[1] + block.counts[1]; ++j) {
      for (std::int64_t i = block.first[0]; i < block.first[0] + block.counts[0]; ++i) {
        points.push_back({lattice.coordinate(0, i), lattice.coordinate(1, j), lattice.coordinate(2, k)});
      }
    }
  }
  return points;
}

std::vector<double> band_of(const DistanceEvaluator& distance, const Lattice& lattice, const LatticeBlock& block,
                            double band) {
  std::vector<double> distances(static_cast<std::size_t>(block.size()));
  distance.evaluate(lattice, block, band, distances);
  return distances;
}

std::vector<double> at_points(const DistanceEvaluator& distance, const std::vector<Vec3>& points) {
  std::vector<double> distances(points.size());
  distance.evaluate(points, distances);
  return distances;
}

TEST(Distance, OfPointsIsThatOfTheOracle) {
  const TriangleMesh mesh = test::assorted_triangles();
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  std::vector<Vec3> points;
  for (int n = 0; n < 3000; ++n) points.push_back({normal(random), normal(random), normal(random)});
  const std::vector<double> distances = at_points(DistanceEvaluator(mesh), points);
  for (std::size_t n = 0; n < points.size(); ++n) {
    // Some dozens of roundings of numbers below 10.
    EXPECT_NEAR(distances[n], static_cast<double>(direct_distance(mesh, points[n])), 1e-13);
  }
}

TEST(Distance, OfSamplesIsThatOfTheOracleInTheBand) {
  const TriangleMesh mesh = test::assorted_triangles();
  const Lattice lattice = unit_lattice(14);
  for (const double voxels : {0.5, 1.0, 3.0, 100.0}) {
    const double band = voxels * lattice.spacing.x;
    const std::vector<double> distances = band_of(DistanceEvaluator(mesh), lattice, whole(lattice), band);
    const std::vector<Vec3> points = samples_of(lattice, whole(lattice));
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
    const std::vector<double> points = at_points(distance, samples_of(lattice, whole(lattice)));
    std::size_t in_band = 0;
    for (std::size_t n = 0; n < samples.size(); ++n) {
      ASSERT_EQ(samples[n], std::min(points[n], band)) << n;
      in_band += samples[n] < band ? 1 : 0;
    }
    EXPECT_GT(in_band, samples.size() / 20);
    EXPECT_LT(in_band, samples.size());
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
    const std::vector<double> all = at_points(distance, samples_of(lattice, layer));
    for (std::size_t n = 0; n < alone.size(); ++n) ASSERT_EQ(alone[n], std::min(all[n], band));
  }
}

TEST(Distance, ScalesWithTheMesh) {
  const TriangleMesh mesh = test::assorted_triangles();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-1, 2);
  std::vector<Vec3> points;
  for (int n = 0; n < 100; ++n) points.push_back({number(random), number(random), number(random)});
  const std::vector<double> expected = at_points(DistanceEvaluator(mesh), points);
  for (const int exponent : {-900, -3, 3, 1000}) {
    TriangleMesh scaled_mesh = mesh;
    std::vector<Vec3> scaled_points = points;
    for (auto* const vertices : {&scaled_mesh.vertices, &scaled_points}) {
      for (Vec3& p : *vertices) p = {std::ldexp(p.x, exponent), std::ldexp(p.y, exponent), std::ldexp(p.z, exponent)};
    }
    const std::vector<double> actual = at_points(DistanceEvaluator(scaled_mesh), scaled_points);
    for (std::size_t n = 0; n < points.size(); ++n) EXPECT_EQ(actual[n], std::ldexp(expected[n], exponent));
  }
}

TEST(Distance, HoldsFarAway) {
  const DistanceEvaluator distance(test::box_mesh({0, 0, 0}, {1, 1, 1}));
  const double largest = std::numeric_limits<double>::max();
  const std::vector<Vec3> points{{1e6, 0, 0}, {3e20, 4e20, 0}, {0, 0, -1e300}, {largest, largest, largest}};
  const std::vector<double> distances = at_points(distance, points);
  EXPECT_EQ(distances[0], 1e6 - 1);
  EXPECT_DOUBLE_EQ(distances[1], 5e20);
  EXPECT_DOUBLE_EQ(distances[2], 1e300);
  EXPECT_EQ(distances[3], largest) << "as large as doubles get";
  const DistanceEvaluator from_speck(test::box_mesh({0, 0, 0}, {1e-300, 1e-300, 1e-300}));
  EXPECT_DOUBLE_EQ(at_points(from_speck, {{3e-200, 4e-200, 0}})[0], 5e-200);
  EXPECT_DOUBLE_EQ(at_points(from_speck, {{0, 3e200, 4e200}})[0], 5e200);
}

}  // namespace
}  // namespace raycone
