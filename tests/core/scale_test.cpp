// The power of two that meshes are scaled by, against its definition.
#include "core/exact/scale.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace raycone::test {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// By definition: over the corners of triangles.
int exponent_by_definition(const TriangleMesh& mesh) {
  double largest = 0.0;
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) {
      for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, std::abs(mesh.vertices[v][axis]));
    }
  }
  int exponent = 0;
  std::frexp(largest, &exponent);
  return exponent;
}

// A triangle among vertices that it does not use.
TriangleMesh with_unused(const std::vector<Vec3>& corners, const Vec3& unused) {
  return {{unused, corners[0], corners[1], unused, corners[2]}, {{1, 2, 4}}};
}

TEST(Scale, IsThatOfTheVerticesThatTrianglesUse) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> exponents(-1070, 1020);
  std::uniform_real_distribution<double> numbers(-1.0, 1.0);
  const auto number = [&] { return std::ldexp(numbers(random), exponents(random)); };
  for (int i = 0; i < 2000; ++i) {
    std::vector<Vec3> corners(3);
    for (Vec3& p : corners) p = {number(), number(), number()};
    for (const double far : {0.0, 5e-324, 1.0, 1.7e308, -1.7e308, kInfinite, -kInfinite, kNan, number()}) {
      const TriangleMesh mesh = with_unused(corners, {far, number(), far});
      ASSERT_EQ(largest_exponent(mesh), exponent_by_definition(mesh)) << "mesh " << i << ", unused " << far;
      const TriangleMesh alone{corners, {{0, 1, 2}}};
      ASSERT_EQ(unit_scale(mesh).exponent(), unit_scale(alone).exponent()) << "mesh " << i << ", unused " << far;
    }
  }
}

TEST(Scale, OfNothingIsOne) {
  EXPECT_EQ(largest_exponent({}), 0);
  EXPECT_EQ(unit_scale({}).exponent(), 0);
  EXPECT_EQ(largest_exponent(with_unused({{0, 0, 0}, {-0.0, 0, 0}, {0, 0, 0}}, {3, 4, 5})), 0);
}

TEST(Scale, LosesNoBit) {
  // 2^1000 beside 2^-1000 cannot be brought to 1 without losing the small one's bits.
  EXPECT_EQ(unit_scale({{{0x1p1000, 0, 0}, {0x1.8p-1000, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}).exponent(), 0);
  // Nor can a number next to 2^-60; 2^-60 itself can.
  for (int axis = 0; axis < 3; ++axis) {
    TriangleMesh mesh{{{0x1p1000, 0, 0}, {0, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
    mesh.vertices[1][axis] = 0x1.0000000000001p-60;
    EXPECT_EQ(unit_scale(mesh).exponent(), 0) << axis;
    mesh.vertices[1][axis] = 0x1p-60;
    EXPECT_EQ(unit_scale(mesh).exponent(), -1001) << axis;
  }
  // That holds for used vertices only.
  EXPECT_EQ(unit_scale(with_unused({{0x1p1000, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0x1.8p-1000, 0, 0})).exponent(), -1001);
}

}  // namespace
}  // namespace raycone::test
