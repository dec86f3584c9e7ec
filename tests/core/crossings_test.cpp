#include "core/crossings/crossings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/machine/floating_point.h"
#include "tests/support/exact_predicates.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::Random;
using test::uniform;
using Corners = std::array<Vec3, 3>;

double whole_number(Random& random, double most) { return std::floor(uniform(random, -most, most + 1)); }

// Of whole numbers, so that rows meet corners, edges and planes, and samples lie on edges. Flat ones, needles and
// points are among them.
Corners random_corners(Random& random, double most) {
  Corners corners;
  for (Vec3& p : corners) p = {whole_number(random, most), whole_number(random, most), whole_number(random, most)};
  if (uniform(random, 0.0, 1.0) < 0.5) {
    const Vec3 step{whole_number(random, 3), whole_number(random, 3), 0.0};
    corners[1] = corners[0] + std::floor(uniform(random, 1.0, most)) * step;
  }
  if (uniform(random, 0.0, 1.0) < 0.5) corners[1].z = corners[2].z = corners[0].z;
  if (uniform(random, 0.0, 1.0) < 0.1) corners[1].y = corners[0].y;
  if (uniform(random, 0.0, 1.0) < 0.1) corners[2] = corners[1];
  return corners;
}

struct Found {
  int none = 0, one = 0, several = 0;
};

// The samples that are said to be on the triangle are those that the oracle says are.
void expect_samples_on(const Corners& corners, const Row& row, Found& found) {
  const auto& [a, b, c] = corners;
  const TrianglePlane plane(a, b, c);
  for (const TrianglePlane* known : {&plane, static_cast<const TrianglePlane*>(nullptr)}) {
    const TriangleCrossing crossing = triangle_crossing(a, b, c, row, known);
    int on = 0;
    for (std::size_t i = 0; i < row.xs.size(); ++i) {
      const bool is_on = test::exactly_on_triangle(a, b, c, row.query(i));
      ASSERT_EQ(crossing.on_begin <= i && i < crossing.on_end, is_on)
          << "sample at " << row.xs[i] << ", " << row.y << ", " << row.z;
      on += is_on ? 1 : 0;
    }
    ++(on == 0 ? found.none : on == 1 ? found.one : found.several);
  }
}

// Scaled, and moved along x by a multiple of the scale, so that coordinates stay exact.
void expect_samples_on_any(double scale, double offset) {
  const DefaultFloatingPoint guard;
  Random random(1);
  Found found;
  for (int round = 0; round < 2000; ++round) {
    const double most = round % 2 == 0 ? 3 : 100;
    Corners corners = random_corners(random, most);
    std::vector<double> xs;
    for (double x = -most - 1; x <= most + 1; x += 1) xs.push_back((x + offset) * scale);
    const Vec3& at = corners[static_cast<std::size_t>(round) % 3];
    const double y = round % 5 == 0 ? at.y : whole_number(random, most);
    const double z = round % 7 == 0 ? whole_number(random, most) : at.z;
    for (Vec3& p : corners) p = scale * (p + Vec3{offset, 0.0, 0.0});
    expect_samples_on(corners, {y * scale, z * scale, xs, round % 4 == 0 ? 0.0 : 1 / scale}, found);
    if (testing::Test::HasFatalFailure()) return;
  }
  EXPECT_GT(std::min({found.none, found.one, found.several}), 300);
}

TEST(TriangleCrossing, FindsTheSamplesOnTriangles) { expect_samples_on_any(1.0, 0.0); }
TEST(TriangleCrossing, FindsTheSamplesOnTrianglesFarFromTheOrigin) { expect_samples_on_any(0.125, 0x1p49); }
TEST(TriangleCrossing, FindsTheSamplesOnTinyTriangles) { expect_samples_on_any(0x1p-1074, 0.0); }
TEST(TriangleCrossing, FindsTheSamplesOnHugeTriangles) { expect_samples_on_any(0x1p+1010, 0.0); }

// Where differences overflow, nothing is known beforehand.
TEST(TriangleCrossing, FindsTheSamplesOnTrianglesWithoutDifferences) {
  const DefaultFloatingPoint guard;
  constexpr double kFar = 0x1.8p1023;
  const std::vector<double> xs{-kFar, -1.0, 0.0, 0x1p1022, kFar};
  Found found;
  expect_samples_on({Vec3{-kFar, -1, 0}, Vec3{kFar, -1, 0}, Vec3{kFar, 1, 0}}, {-1.0, 0.0, xs, 0.0}, found);
  expect_samples_on({Vec3{-kFar, -kFar, 0}, Vec3{kFar, kFar, 0}, Vec3{kFar, 0, 0}}, {0.0, 0.0, xs, 0.0}, found);
  EXPECT_EQ(found.several, 4);
  const std::vector<double> near{-2.0, -1.0, 0.0, 0.25, 0.5, 1.0, 2.0};
  expect_samples_on({Vec3{-1, -kFar, 0}, Vec3{1, kFar, 0}, Vec3{1, -kFar, 0}}, {0.0, 0.0, near, 0.0}, found);
  expect_samples_on({Vec3{1, kFar, 0}, Vec3{-1, -kFar, 0}, Vec3{1, -kFar, 0}}, {0.0, 0.0, near, 0.0}, found);
  EXPECT_EQ(found.several, 8);
}

}  // namespace
}  // namespace raycone
