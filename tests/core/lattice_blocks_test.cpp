// Blocks of lattices: their sums, and winding numbers from them, against direct sums.
#include "core/far/lattice_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numbers>
#include <span>
#include <vector>

#include "core/boundary/solid_angles.h"
#include "core/data/rule.h"
#include "core/evaluation/winding_number.h"
#include "core/far/harmonic_error.h"
#include "core/far/harmonic_fit.h"
#include "core/far/lattice_blocks_walk.h"
#include "tests/support/diagnosed.h"
#include "tests/support/differences.h"
#include "tests/support/shapes.h"
#include "tests/support/values.h"

namespace raycone {
namespace {

using test::dust;
using test::Random;

Lattice cube_lattice(std::int64_t count) {
  const double spacing = 1.0 / static_cast<double>(count - 1);
  return {{-0.5, -0.5, -0.5}, {spacing, spacing, spacing}, {0, 0, 0}, {count, count, count}};
}

LatticeAxes axes_of(const Lattice& lattice) {
  LatticeAxes axes;
  for (int axis = 0; axis < 3; ++axis) {
    for (std::int64_t i = 0; i < lattice.counts[static_cast<std::size_t>(axis)]; ++i) {
      axes[static_cast<std::size_t>(axis)].push_back(lattice.coordinate(axis, i));
    }
  }
  return axes;
}

std::vector<double> sums_of(const LatticeBlocks& blocks, const LatticeAxes& axes, const SampleBox& part) {
  std::vector<double> sums(part.size());
  blocks.for_each_row(axes, part, [&](std::size_t x, std::size_t y, std::size_t z, std::span<const double> row) {
    const std::size_t number = (z - part.begin[2]) * part.side(1) + y - part.begin[1];
    std::ranges::copy(row, sums.begin() + static_cast<std::ptrdiff_t>(number * part.side(0) + x - part.begin[0]));
  });
  return sums;
}

constexpr std::uint32_t kSideOfBlocks = 33;

SampleBox whole_of(const LatticeAxes& axes) { return {{0, 0, 0}, {axes[0].size(), axes[1].size(), axes[2].size()}}; }

// Of a box around the dust, with cubic voxels.
Lattice box_lattice(std::int64_t nx, std::int64_t ny, std::int64_t nz) {
  const double spacing = 1.0 / static_cast<double>(std::max({nx, ny, nz}) - 1);
  const auto first = [&](std::int64_t count) { return -0.5 * spacing * static_cast<double>(count - 1); };
  return {{first(nx), first(ny), first(nz)}, {spacing, spacing, spacing}, {0, 0, 0}, {nx, ny, nz}};
}

void expect_sums_within(double tolerance, std::span<const SolidTriangle> triangles, const LatticeAxes& axes) {
  const LatticeBlocks blocks({triangles.begin(), triangles.end()}, tolerance, SimdLevel::kBest);
  const std::vector<double> sums = sums_of(blocks, axes, whole_of(axes));
  const std::size_t nx = axes[0].size(), ny = axes[1].size();
  double largest = 0.0;
  for (std::size_t n = 0; n < sums.size(); n += 37) {
    SampleTile tile;
    tile.clear();
    tile.add({axes[0][n % nx], axes[1][n / nx % ny], axes[2][n / nx / ny]});
    tile.fill_up();
    ProductTile products;
    solid_angle_kernel(SimdLevel::kBest)(triangles, tile, products);
    const double w = static_cast<double>(products.turns(0)) + products.argument[0];
    largest = test::larger_difference(largest, std::abs(sums[n] - w));
  }
  EXPECT_LT(largest, tolerance);
  EXPECT_GT(largest, tolerance * 1e-5);  // polynomials are at work
}

TEST(LatticeBlocksTest, SumsAreWithinTheTolerance) {
  Random random(6);
  const std::vector<SolidTriangle> triangles = solid_faces(dust(random, 300)).triangles;
  for (const double tolerance : {1e-4, 1e-7, 1e-10}) {
    expect_sums_within(tolerance, triangles, axes_of(cube_lattice(kSideOfBlocks)));
  }
  for (const auto& [nx, ny, nz] : {std::array{120, 100, 8}, std::array{8, 8, 1500}, std::array{30, 400, 9}}) {
    expect_sums_within(1e-7, triangles, axes_of(box_lattice(nx, ny, nz)));
  }
}

// A part of a sphere, level with samples: rays pass through vertices and along edges.
TEST(LatticeBlocksTest, WhatIsNearIsTheSameByItsBoundary) {
  TriangleMesh mesh = test::moved(test::sphere(24), {0.375, 0.375, 0.375}, {0, 0, 0});
  mesh.triangles.resize(mesh.triangles.size() * 2 / 3);
  const std::vector<SolidTriangle> triangles = solid_faces(mesh).triangles;
  const LatticeAxes axes = axes_of(cube_lattice(kSideOfBlocks));
  const LatticeBlocks by_triangles(triangles, 1e-13, SimdLevel::kBest);
  const LatticeBlocks by_boundary(triangles, 1e-13, SimdLevel::kBest, LatticeBlocks::Near::kBoundary);
  const std::vector<double> expected = sums_of(by_triangles, axes, whole_of(axes));
  const std::vector<double> sums = sums_of(by_boundary, axes, whole_of(axes));
  std::size_t different = 0;
  for (std::size_t n = 0; n < sums.size(); ++n) {
    ASSERT_NEAR(sums[n], expected[n], 1e-11) << n;
    if (sums[n] != expected[n]) ++different;
  }
  EXPECT_GT(different, sums.size() / 4);
}

// The most that fields of blocks are off by, as they say themselves.
double most_spent(const LatticeBlocksWalk& walk, const LatticeBlocksWalk::Division& division) {
  double most = 0.0;
  for (const SampleBlock& child : division.children) {
    const LatticeBlocksWalk::Division next = walk.divide(child);
    most = std::max(most, walk.pays(child, next) ? most_spent(walk, next) : child.spent);
  }
  return most;
}

TEST(LatticeBlocksTest, LevelsShareTheBudgetAndUseIt) {
  Random random(9);
  const LatticeBlocks blocks(solid_faces(dust(random, 300)).triangles, 1e-6, SimdLevel::kBest);
  for (const auto& [nx, ny, nz] :
       {std::array{33, 33, 33}, std::array{128, 128, 128}, std::array{2000, 64, 64}, std::array{16, 9000, 16},
        std::array{700, 500, 8}, std::array{8, 8, 100'000}, std::array{61, 67, 900}}) {
    const LatticeAxes axes = axes_of(box_lattice(nx, ny, nz));
    const LatticeBlocksWalk walk(blocks, axes);
    const double spent = most_spent(walk, walk.whole());
    EXPECT_LE(spent, walk.far_budget()) << nx << ' ' << ny << ' ' << nz;
    EXPECT_GE(spent, walk.far_budget() / 10) << nx << ' ' << ny << ' ' << nz;
  }
}

// What the fit of a block is off by at most: the sum over those of `around`, which is near the block around it, that
// are far from it.
double error_of_fit(const LatticeBlocks& blocks, const SampleBlock& block, std::span<const std::uint32_t> around) {
  std::vector<std::uint32_t> far;
  std::ranges::set_difference(around, block.near, std::back_inserter(far));
  double error = 0.0;
  for (const std::uint32_t n : far) {
    const TriangleExtent& t = blocks.extents()[n];
    double distance = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      distance = std::max(
          {distance, t.box.lower[axis] - block.cube.centre[axis], block.cube.centre[axis] - t.box.upper[axis]});
    }
    distance /= block.cube.half;
    const double moved = 0x1p-53 * (largest_coordinate(block.cube.centre) + 2 * block.cube.half) / block.cube.half;
    const double of_moved = HarmonicFit::kLargestWeights * std::sqrt(3.0) * moved /
                            (2 * std::numbers::pi * std::pow(distance - 1 - moved, 3));
    error += t.area / (block.cube.half * block.cube.half) * (dipole_error(distance) + of_moved);
  }
  return error;
}

// How many leaves of the tree are partly among the triangles.
std::size_t parts_of_leaves(const SourceTree& tree, std::span<const std::uint32_t> triangles) {
  std::size_t parts = 0;
  for (const SourceNode& node : tree.nodes()) {
    if (node.own_end != node.end) continue;
    const auto in_leaf = [&](std::uint32_t n) { return node.begin <= n && n < node.end; };
    const auto count = static_cast<std::size_t>(std::ranges::count_if(triangles, in_leaf));
    if (count > 0 && count < node.triangles()) ++parts;
  }
  return parts;
}

TEST(LatticeBlocksTest, WhatIsSpentIsTheSumOfErrorsAlsoOfWholeLeaves) {
  Random random(10);
  for (const int count : {600, 20'000}) {
    const LatticeBlocks blocks(solid_faces(dust(random, count)).triangles, 1e-6, SimdLevel::kBest);
    const LatticeAxes axes = axes_of(cube_lattice(200));
    const LatticeBlocksWalk walk(blocks, axes);
    SampleBlock block = walk.whole().children.front();
    std::size_t far = 0, parts = 0;
    for (int level = 0; level < 3; ++level) {
      const LatticeBlocksWalk::Division division = walk.divide(block);
      for (const SampleBlock& child : division.children) {
        const double error = error_of_fit(blocks, child, block.near);
        EXPECT_NEAR(child.spent - block.spent, error, 1e-9 * error + 1e-21);  // sums round
        far += block.near.size() - child.near.size();
        parts += parts_of_leaves(blocks.tree(), child.near);
      }
      block = division.children.front();
    }
    EXPECT_GT(far, 1000U);
    EXPECT_EQ(parts > 0, count < 1000);
  }
}

TEST(LatticeBlocksTest, PartsAndLevelsHaveTheSameBits) {
  Random random(7);
  const std::vector<SolidTriangle> triangles = solid_faces(dust(random, 200)).triangles;
  const LatticeAxes axes = axes_of(cube_lattice(kSideOfBlocks));
  const SampleBox all = whole_of(axes);
  const std::vector<double> sums = sums_of(LatticeBlocks(triangles, 1e-8, SimdLevel::kBest), axes, all);
  for (const SimdLevel level : {SimdLevel::kSse4, SimdLevel::kAvx2}) {
    EXPECT_EQ(sums_of(LatticeBlocks(triangles, 1e-8, level), axes, all), sums);
  }
  const SampleBox part{{5, 15, 3}, {30, 17, 14}};
  const std::vector<double> some = sums_of(LatticeBlocks(triangles, 1e-8, SimdLevel::kBest), axes, part);
  for (std::uint32_t z = 3; z < 14; ++z) {
    for (std::uint32_t y = 15; y < 17; ++y) {
      for (std::uint32_t x = 5; x < 30; ++x) {
        EXPECT_EQ(some[((z - 3) * 2 + y - 15) * 25 + x - 5], sums[(z * kSideOfBlocks + y) * kSideOfBlocks + x]);
      }
    }
  }
}

TEST(LatticeBlocksTest, PartsAndLevelsHaveTheSameBitsByBoundaries) {
  TriangleMesh mesh = test::moved(test::sphere(24), {0.4, 0.37, 0.31}, {0.01, 0.02, 0});
  mesh.triangles.resize(mesh.triangles.size() * 2 / 3);
  const std::vector<SolidTriangle> triangles = solid_faces(mesh).triangles;
  const LatticeAxes axes = axes_of(cube_lattice(kSideOfBlocks));
  constexpr auto kBoundary = LatticeBlocks::Near::kBoundary;
  const LatticeBlocks blocks(triangles, 1e-8, SimdLevel::kBest, kBoundary);
  const std::vector<double> sums = sums_of(blocks, axes, whole_of(axes));
  for (const SimdLevel level : {SimdLevel::kSse4, SimdLevel::kAvx2}) {
    EXPECT_EQ(sums_of(LatticeBlocks(triangles, 1e-8, level, kBoundary), axes, whole_of(axes)), sums);
  }
  Random random(8);
  for (int n = 0; n < 1000; ++n) {
    const auto x = static_cast<std::uint32_t>(random() % kSideOfBlocks),
               y = static_cast<std::uint32_t>(random() % kSideOfBlocks);
    const auto z = static_cast<std::uint32_t>(random() % kSideOfBlocks);
    const std::vector<double> one = sums_of(blocks, axes, {{x, y, z}, {x + 1, y + 1, z + 1}});
    ASSERT_EQ(one[0], sums[(z * kSideOfBlocks + y) * kSideOfBlocks + x]) << x << ' ' << y << ' ' << z;
  }
}

// ---- Winding numbers -------------------------------------------------------------------------------------------

TriangleMesh small_sieve() { return test::moved(test::sieve(24, 5), {0.45, 0.45, 0.45}, {0, 0, 0}); }

WindingNumberEvaluator evaluator(const TriangleMesh& mesh, double tolerance) {
  return WindingNumberEvaluator(mesh, {.summation = Summation::kBlocks, .accuracy = {tolerance}});
}

TEST(LatticeBlocksTest, WindingNumbersAreWithinTheToleranceOfTheDirectSum) {
  const TriangleMesh mesh = small_sieve();
  const Lattice lattice = cube_lattice(64);
  std::vector<double> direct(64 * 64 * 4), values(64 * 64 * 4);
  const LatticeBlock layers{{0, 0, 30}, {64, 64, 4}};  // across which slabs are cut
  evaluator(mesh, 0.0).evaluate(lattice, layers, direct);
  for (const double tolerance : {1e-5, 1e-9}) {
    const WindingNumberEvaluator coarse = evaluator(mesh, tolerance);
    const Tally tally = coarse.evaluate(lattice, layers, values);
    EXPECT_GT(coarse.terms().near, 0U);
    EXPECT_GE(coarse.terms().far, values.size());  // the polynomial of each
    EXPECT_EQ(tally.degenerate, evaluator(mesh, 0.0).evaluate(lattice, layers, direct).degenerate);
    const double largest = test::largest_difference(values, direct);
    EXPECT_LT(largest, tolerance);
    EXPECT_GT(largest, tolerance * 1e-5);
  }
}

// Coordinates there tell nodes of fits apart as roughly as samples.
TEST(LatticeBlocksTest, WindingNumbersAreWithinTheToleranceFarFromTheOrigin) {
  for (const double offset : {0x1p20, 0x1p26, 0x1p32}) {
    TriangleMesh mesh = small_sieve();
    for (Vec3& v : mesh.vertices) {
      for (int axis = 0; axis < 3; ++axis) v[axis] += offset;
    }
    Lattice lattice = cube_lattice(64);
    lattice.origin = lattice.origin + Vec3{offset, offset, offset};
    const LatticeBlock layers{{0, 0, 30}, {64, 64, 4}};
    const std::vector<double> direct = test::values_of(evaluator(mesh, 0.0), lattice, layers);
    for (const double tolerance : {1e-4, 1e-10, 1e-11}) {
      const WindingNumberEvaluator coarse = evaluator(mesh, tolerance);
      EXPECT_LT(test::largest_difference(test::values_of(coarse, lattice, layers), direct), tolerance) << offset;
      if (tolerance == 1e-4) {
        EXPECT_GE(coarse.terms().far, direct.size()) << "no polynomials: nothing was tested";
      }
    }
  }
}

// Sheets side by side that all face one way, t from the corner of a box about (offset, offset, offset): rounding moves
// the nodes of its fits, and what that changes adds up.
TriangleMesh sheets(double offset, int count, double t) {
  const double step = std::nextafter(offset, HUGE_VAL) - offset;
  TriangleMesh mesh;
  for (int n = 0; n < count; ++n) {
    const double x = offset - t - n * step;
    test::add_triangle(mesh, {x, offset - 7, offset}, {x, offset, offset - 14}, {x, offset + 7, offset});
  }
  return mesh;
}

TEST(LatticeBlocksTest, MovedNodesOfFitsKeepTheTolerance) {
  struct Case {
    double offset, tolerance, t;
    int count;
  };
  // With what nodes change left out, 1.2 to 6 times the tolerance.
  for (const Case& c :
       {Case{6.5e9, 1e-4, 4.0, 5000}, Case{1.2e5, 1e-10, 6.45, 2500}, Case{1.2e5, 1.1e-11, 6.45, 500}}) {
    const TriangleMesh mesh = sheets(c.offset, c.count, c.t);
    constexpr double kSpacing = 1.0 / 32;
    const Lattice lattice{{c.offset - 1, c.offset - 1, c.offset - 1}, {kSpacing, kSpacing, kSpacing}, {}, {64, 64, 64}};
    const LatticeBlock layers{{0, 0, 30}, {64, 64, 2}};
    const double largest = test::largest_difference(test::values_of(evaluator(mesh, c.tolerance), lattice, layers),
                                                    test::values_of(evaluator(mesh, 0.0), lattice, layers));
    EXPECT_LE(largest, c.tolerance) << c.offset;
  }
}

// The same in blocks of points: 5.5e-5 with what nodes change left out.
TEST(LatticeBlocksTest, MovedNodesOfFitsKeepTheToleranceAtPoints) {
  constexpr double kOffset = 7e9, kTolerance = 3e-5;
  TriangleMesh mesh = sheets(kOffset, 50'000, 4.0);
  for (std::size_t n = 0; n < mesh.vertices.size(); n += 3) {
    const double x = mesh.vertices[n].x;
    mesh.vertices[n] = {x, kOffset - 7, kOffset - 7};
    mesh.vertices[n + 1] = {x, kOffset + 7, kOffset - 7};
    mesh.vertices[n + 2] = {x, kOffset, kOffset + 7};
  }
  const auto end = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {{kOffset + 20, kOffset - 7, kOffset - 7},
                                             {kOffset + 20, kOffset - 7, kOffset - 6.9},
                                             {kOffset + 20, kOffset - 6.9, kOffset - 7}});
  mesh.triangles.push_back({end, end + 1, end + 2});  // so that there is a box to be filled
  Random random(1);
  std::vector<Vec3> points(600);
  for (Vec3& p : points) {
    p = Vec3{kOffset, kOffset, kOffset} + test::uniform_point(random, {{8, -7, -7}, {20, 7, 7}});
  }
  const WindingNumberEvaluator coarse(
      mesh, {.summation = Summation::kBlocks, .accuracy = {.tolerance = kTolerance, .points = 250'000}});
  const double largest =
      test::largest_difference(test::values_of(coarse, points), test::values_of(evaluator(mesh, 0.0), points));
  EXPECT_LE(largest, kTolerance);
}

TEST(LatticeBlocksTest, SamplesAreDoneOnce) {
  const TriangleMesh mesh = small_sieve();
  const Lattice lattice = cube_lattice(12);  // of whole blocks and parts
  const auto count = static_cast<std::size_t>(whole(lattice).size());
  test::Diagnosed found(count);
  const Diagnostics diagnostics = found.spans();
  for (const Summation summation : {Summation::kBlocks, Summation::kFarField, Summation::kCone}) {
    const WindingNumberEvaluator evaluator(mesh, {.summation = summation, .accuracy = {1e-5}});
    for (const Diagnostics* const with : {static_cast<const Diagnostics*>(nullptr), &diagnostics}) {
      std::atomic<std::uint64_t> done = 0;
      evaluator.evaluate(lattice, whole(lattice), found.values, &done, with);
      EXPECT_EQ(done, count);
    }
  }
}

TEST(LatticeBlocksTest, HalfIntegersStayHalfIntegers) {
  // The rim is in one plane: there, the winding number is a half-integer or 0 in a whole layer.
  const TriangleMesh mesh = test::notched_fan();
  Lattice lattice = cube_lattice(96);
  lattice.origin.z = -48 * lattice.spacing.z;  // a layer at z = 0
  LatticeBlock layer{{0, 0, 8}, {96, 96, 1}};
  const WindingNumberEvaluator exact = evaluator(mesh, 0.0), coarse = evaluator(mesh, 1e-3);
  EXPECT_NE(test::values_of(coarse, lattice, layer), test::values_of(exact, lattice, layer));  // blocks are used
  layer.first[2] = 48;
  const std::vector<double> direct = test::values_of(exact, lattice, layer),
                            values = test::values_of(coarse, lattice, layer);
  EXPECT_GT(std::ranges::count_if(direct, [](double w) { return std::abs(w) == 0.5; }), 100);
  for (std::size_t n = 0; n < values.size(); ++n) {
    EXPECT_EQ(values[n] == 0.5, direct[n] == 0.5);
    EXPECT_EQ(values[n] > 0.5, direct[n] > 0.5);
  }
}

// A sieve so small, beside a box, that squares of its triangles' areas are no doubles. The box is nowhere on the rays.
TEST(LatticeBlocksTest, AreasWhoseSquaresUnderflowAreNotNothing) {
  const TriangleMesh alone = small_sieve();
  const Lattice lattice = cube_lattice(24);
  const std::vector<double> expected = test::values_of(evaluator(alone, 0.0), lattice);
  for (const int exponent : {-250, -290, -350}) {
    const double unit = std::ldexp(1.0, exponent);
    const TriangleMesh mesh =
        test::joined(test::moved(alone, {unit, unit, unit}, {}), test::box_mesh({0.5, 0.5, 0.5}, {1, 1, 1}));
    const Lattice tiny{unit * lattice.origin, unit * lattice.spacing, lattice.index_min, lattice.counts};
    const WindingNumberEvaluator by_blocks = evaluator(mesh, 1e-9);
    const std::vector<double> values = test::values_of(by_blocks, tiny);
    const double largest = test::largest_difference(values, expected);
    EXPECT_LT(largest, 1e-9) << exponent;
    Rule rule;
    rule.threshold = 0.3;
    std::vector<std::uint8_t> sides(values.size());
    by_blocks.evaluate_sides(rule, tiny, whole(tiny), sides);
    std::uint64_t wrong = 0;
    for (std::size_t n = 0; n < values.size(); ++n) {
      if (std::abs(expected[n] - 0.3) > 1e-9) wrong += sides[n] != static_cast<std::uint8_t>(expected[n] > 0.3);
    }
    EXPECT_EQ(wrong, 0U) << exponent;
  }
}

// The same, from so far away that its size is no double in units of the distance, nor the distance in units of it.
TEST(LatticeBlocksTest, WhatIsTooFarAwayToBeSeenIsNothing) {
  const Lattice near = cube_lattice(24);
  for (const int exponent : {-33, -100}) {
    const double unit = std::ldexp(1.0, exponent);
    const TriangleMesh mesh =
        test::joined(test::moved(small_sieve(), {unit, unit, unit}, {}), test::box_mesh({0.5, 0.5, 0.5}, {1, 1, 1}));
    for (const double away : {1e280, 1e296, 1e299, 1e306}) {
      const Lattice far{away * near.origin, away * near.spacing, near.index_min, near.counts};
      for (const Summation summation : {Summation::kBlocks, Summation::kFarField}) {
        const std::vector<double> values =
            test::values_of(WindingNumberEvaluator(mesh, {.summation = summation, .accuracy = {1e-9}}), far);
        for (const double value : values) ASSERT_LE(std::abs(value), 1e-9) << away << " or NaN";
      }
    }
  }
}

}  // namespace
}  // namespace raycone
