// The two ways to a lattice's distances, against the tree and each other.
#include "core/distance/distance_band.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/shapes.h"

namespace raycone {
namespace {

std::vector<double> evenly(double first, double step, int count) {
  std::vector<double> values;
  for (int n = 0; n < count; ++n) values.push_back(first + n * step);
  return values;
}

LatticeRows rows_of(int nx, int ny, int nz, double step) {
  const double per_unit = 1 / step;
  return {evenly(-0.1, step, nx), evenly(0.02, step, ny), evenly(-0.05, step, nz), {per_unit, per_unit, per_unit}};
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

void expect_both_right(const TriangleMesh& mesh, const LatticeRows& rows, double band) {
  const DistanceTree tree(mesh);
  std::vector<double> squares(rows.xs.size() * rows.size());
  rasterize_distances(mesh, rows, band, squares);
  expect_searched(squares, rows, tree, band);
  std::ranges::fill(squares, -1.0);
  descend_to_distances(tree, rows, band, squares);
  expect_searched(squares, rows, tree, band);
}

TEST(DistanceBand, IsTheSameBothWays) {
  const double step = 0.05;
  for (const double band : {0.4 * step, 3 * step, 11 * step}) {
    expect_both_right(test::assorted_triangles(), rows_of(25, 21, 27, step), band);
    expect_both_right(test::box_mesh({0, 0, 0}, {0.7, 0.8, 0.9}), rows_of(25, 21, 27, step), band);
  }
}

TEST(DistanceBand, OfSlabsOfEveryDirection) {
  expect_both_right(test::assorted_triangles(), rows_of(1, 60, 50, 0.02), 0.06);
  expect_both_right(test::assorted_triangles(), rows_of(60, 1, 50, 0.02), 0.06);
  expect_both_right(test::assorted_triangles(), rows_of(60, 50, 1, 0.02), 0.06);
  expect_both_right(test::assorted_triangles(), rows_of(1, 1, 1, 1.0), 5.0);
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
  expect_both_right(test::moved(test::assorted_triangles(), {unit, unit, unit}, unit * far), rows, 0.15 * unit);
}

TEST(DistanceBand, SmallTrianglesAreSearchedLargeOnesRasterized) {
  EXPECT_FALSE(descent_is_faster(test::box_mesh({0, 0, 0}, {1, 1, 1}), 0.05));
  EXPECT_TRUE(descent_is_faster(test::sphere(60), 0.5));
}

}  // namespace
}  // namespace raycone
