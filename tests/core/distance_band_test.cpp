// A lattice's distances by blocks, against a search for each sample.
#include "core/distance/distance_band.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "core/distance/triangle_distance.h"
#include "tests/support/lattice_rows.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

LatticeRows rows_of(std::int64_t nx, std::int64_t ny, std::int64_t nz, double step) {
  return test::rows_of({{-0.1, 0.02, -0.05}, {step, step, step}, {0, 0, 0}, {nx, ny, nz}});
}

// What a search for each sample gives, as far as it is in the band.
void expect_searched(const std::vector<double>& squares, const LatticeRows& rows, const DistanceTree& tree,
                     double band) {
  std::size_t n = 0, in_band = 0;
  for (const double z : rows.zs) {
    for (const double y : rows.ys) {
      for (const double x : rows.xs) {
        const double expected = tree.squared_distance({x, y, z});
        if (expected <= band * band) {
          ASSERT_EQ(squares[n], expected) << x << ' ' << y << ' ' << z;
          ++in_band;
        } else {
          ASSERT_GT(squares[n], band * band) << x << ' ' << y << ' ' << z;
        }
        ++n;
      }
    }
  }
  EXPECT_GT(in_band, 0U);
}

constexpr SimdLevel kLevels[]{SimdLevel::kSse4, SimdLevel::kAvx2, SimdLevel::kAvx512};

// At every level of SIMD that the processor has.
void expect_right(const TriangleMesh& mesh, const LatticeRows& rows, double band) {
  for (const SimdLevel level : kLevels) {
    const DistanceTree tree(mesh, level);
    std::vector<double> squares(rows.xs.size() * rows.size(), -1.0);
    fill_band(tree, rows, band, squares);
    expect_searched(squares, rows, tree, band);
  }
}

TEST(DistanceBand, IsWhatSearchesFind) {
  const double step = 0.05;
  for (const double band : {0.4 * step, 3 * step, 11 * step}) {
    expect_right(test::assorted_triangles(), rows_of(25, 21, 27, step), band);
    expect_right(test::box_mesh({0, 0, 0}, {0.7, 0.8, 0.9}), rows_of(25, 21, 27, step), band);
  }
}

TEST(DistanceBand, OfSlabsOfEveryDirection) {
  expect_right(test::assorted_triangles(), rows_of(1, 60, 50, 0.02), 0.06);
  expect_right(test::assorted_triangles(), rows_of(60, 1, 50, 0.02), 0.06);
  expect_right(test::assorted_triangles(), rows_of(60, 50, 1, 0.02), 0.06);
  expect_right(test::assorted_triangles(), rows_of(1, 1, 1, 1.0), 5.0);
}

// Where coordinates are large beside the triangles, roundings are too.
TEST(DistanceBand, FarFromTheOrigin) {
  const Vec3 far{4096, 65536, -1048576};
  const double unit = 0x1p-21;
  LatticeRows rows = rows_of(25, 21, 27, 0.05);
  for (double& x : rows.xs) x = unit * (x + far.x);
  for (double& y : rows.ys) y = unit * (y + far.y);
  for (double& z : rows.zs) z = unit * (z + far.z);
  rows.samples_per_unit = 1 / unit * rows.samples_per_unit;
  expect_right(test::moved(test::assorted_triangles(), {unit, unit, unit}, unit * far), rows, 0.15 * unit);
}

// Of spheres, all of whose triangles are about equally far from the middle.
TEST(DistanceBand, OfManySmallTriangles) {
  const TriangleMesh sphere = test::sphere(20);
  for (const double band : {0.15, 10.0}) expect_right(sphere, rows_of(19, 23, 17, 0.05), band);
}

// Dozens of triangles for each sample, so that a search is made from each.
TEST(DistanceBand, OfLatticesThatAreCoarseForTheirMesh) {
  const TriangleMesh sphere = test::sphere(60);
  for (const double band : {0.3, 10.0}) expect_right(sphere, rows_of(9, 11, 7, 0.15), band);
}

// The closest point of a needle is only known with care. Without it, the triangle above seems to be nearer.
TEST(DistanceBand, BetweenANeedleAndATriangle) {
  const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0.5, 1e-4, 0}, {0, -1, 2.03e-4}, {1, -1, 2.03e-4}, {0.5, 1, 2.03e-4}},
                          {{0, 1, 2}, {3, 4, 5}}};
  const double step = 1e-7;
  const LatticeRows rows = test::rows_of({{0.5, 4e-5, 1e-4}, {step, step, step}, {0, 0, 0}, {8, 8, 8}});
  expect_right(mesh, rows, 1.0);
}

// The least of the triangles' numbers, each found alone.
TEST(DistanceTree, FindsTheLeastAtEveryLevel) {
  const TriangleMesh mesh = test::assorted_triangles();
  test::Random random(4);
  for (const SimdLevel level : kLevels) {
    const DistanceTree tree(mesh, level);
    for (int n = 0; n < 500; ++n) {
      const Vec3 p = test::uniform_point(random, {{-0.5, -0.5, -0.5}, {1.5, 1.5, 1.5}});
      double least = std::numeric_limits<double>::infinity();
      for (const Triangle& t : mesh.triangles) {
        const TriangleDistance triangle(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
        least = std::min(least, triangle.squared(p));
      }
      ASSERT_EQ(tree.squared_distance(p), least) << n;
    }
  }
}

}  // namespace
}  // namespace raycone
