// The order of a search tree's triangles.
#include "core/mesh/triangle_runs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

#include "tests/support/shapes.h"

namespace raycone {
namespace {

constexpr std::size_t kWidth = 8;

// Triangle n is at position[n] along the axis, far closer to it than its neighbours are.
TriangleMesh in_a_row(const std::vector<std::uint32_t>& position, int axis, double scale) {
  TriangleMesh mesh;
  for (const std::uint32_t at : position) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3& corner : {Vec3{0, 0, 0}, Vec3{0.1, 0, 0}, Vec3{0, 0.1, 0.1}}) {
      Vec3 p = corner;
      p[axis] += static_cast<double>(at);
      mesh.vertices.push_back(scale * p);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

std::vector<std::uint32_t> shuffled(std::uint32_t count) {
  std::vector<std::uint32_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0U);
  std::shuffle(numbers.begin(), numbers.end(), std::mt19937(count));
  return numbers;
}

// Run r holds those at r * kWidth and the next ones, in any order.
void expect_consecutive(const std::vector<std::uint32_t>& order, const std::vector<std::uint32_t>& position) {
  ASSERT_EQ(order.size(), position.size());
  for (std::size_t begin = 0; begin < order.size(); begin += kWidth) {
    const std::size_t end = std::min(begin + kWidth, order.size());
    std::vector<std::uint32_t> run;
    for (std::size_t n = begin; n < end; ++n) run.push_back(position[order[n]]);
    std::ranges::sort(run);
    for (std::size_t n = 0; n < run.size(); ++n) ASSERT_EQ(run[n], begin + n);
  }
}

TEST(TriangleRuns, AreConsecutiveTrianglesOfARow) {
  for (const std::uint32_t count : {1U, 8U, 9U, 33U, 200U, 1025U, 20'000U}) {
    const std::vector<std::uint32_t> position = shuffled(count);
    for (const int axis : {0, 1, 2}) {
      expect_consecutive(triangles_in_runs(in_a_row(position, axis, 1.0), kWidth), position);
    }
  }
}

TEST(TriangleRuns, DoNotDependOnTheSizeOfTheMesh) {
  const std::vector<std::uint32_t> position = shuffled(1000);
  for (const double scale : {0x1p-900, 0x1p1013, -0x1p1013}) {
    std::vector<std::uint32_t> expected = position;
    if (scale < 0) std::ranges::for_each(expected, [](std::uint32_t& at) { at = 999 - at; });
    expect_consecutive(triangles_in_runs(in_a_row(position, 0, scale), kWidth), expected);
  }
}

TEST(TriangleRuns, TakeTheLowerTriangleFirstWhereAllAreAtOnePlace) {
  for (const std::uint32_t count : {40U, 3000U}) {
    std::vector<std::uint32_t> number(count);
    std::iota(number.begin(), number.end(), 0U);
    const TriangleMesh mesh = in_a_row(std::vector<std::uint32_t>(count, 1), 0, 1.0);
    expect_consecutive(triangles_in_runs(mesh, kWidth), number);
  }
}

// All triangles of the row are at one place in units of the mesh. Strays cut it into parts of any triangles, each half
// as large as the one before, but within these parts runs are as close together as they can be.
TEST(TriangleRuns, AreCloseTogetherBesideStrayTriangles) {
  constexpr std::uint32_t kRow = 8192;
  const std::vector<std::uint32_t> position = shuffled(kRow);
  TriangleMesh mesh = in_a_row(position, 0, 1.0);
  for (const double at : {1e15, -1e15}) {
    test::add_triangle(mesh, {at, 0, 0}, {1.5 * at, 0, 0}, {at, at, 0});
  }
  const std::vector<std::uint32_t> order = triangles_in_runs(mesh, kWidth);
  ASSERT_EQ(order.size(), kRow + 2);
  std::uint64_t extents = 0;
  for (std::size_t begin = 0; begin < order.size(); begin += kWidth) {
    std::uint32_t least = kRow, most = 0;
    for (std::size_t n = begin; n < std::min(begin + kWidth, order.size()); ++n) {
      if (order[n] >= kRow) continue;
      least = std::min(least, position[order[n]]);
      most = std::max(most, position[order[n]]);
    }
    if (most > least) extents += most - least;
  }
  EXPECT_LT(extents, 20U * kRow);  // in any order, as of random positions: some 700 times as much as the row's length
}

TEST(TriangleRuns, OfNoTrianglesAreNone) { EXPECT_TRUE(triangles_in_runs({}, kWidth).empty()); }

}  // namespace
}  // namespace raycone
