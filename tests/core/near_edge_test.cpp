#include "core/boundary/near_edge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/exact/quad.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

double in_turns(const Factor<double>& f) {
  return static_cast<double>(std::atan2(static_cast<long double>(f.im), static_cast<long double>(f.re)) /
                             (2 * std::numbers::pi_v<long double>));
}

// The argument of z_ab in turns by its definition, in 80-bit arithmetic: well conditioned away from the edge.
double argument_by_definition(const Vec3& a, const Vec3& b, const Vec3& q) {
  using Long = long double;
  const Long ax = Long(a.x) - q.x, ay = Long(a.y) - q.y, az = Long(a.z) - q.z;
  const Long bx = Long(b.x) - q.x, by = Long(b.y) - q.y, bz = Long(b.z) - q.z;
  const Long sa = std::sqrt(ax * ax + ay * ay + az * az) - ax, sb = std::sqrt(bx * bx + by * by + bz * bz) - bx;
  const Long re = sa * sb + ay * by + az * bz, im = ay * bz - az * by;
  return static_cast<double>(std::atan2(im, re) / (2 * std::numbers::pi_v<Long>));
}

TEST(NearEdgeFactor, HasTheArgumentOfThePlainFormWhereThatIsWellConditioned) {
  test::Random random(2);
  const Box box{{-1, -1, -1}, {1, 1, 1}};
  for (int i = 0; i < 20000; ++i) {
    const Vec3 a = test::uniform_point(random, box), b = test::uniform_point(random, box);
    const Vec3 q = test::uniform_point(random, box);
    const Factor<double> f = near_edge_factor<double>(a, b, q).factor;
    // 1e-13: what cancellation in |p| - p_x and near the edge leaves of 64 bits in the worst of 20 000 draws.
    EXPECT_NEAR(in_turns(f), argument_by_definition(a, b, q), 1e-13);
  }
}

// As q approaches the inside of an edge, arg z depends on the direction of approach only, up to terms of the distance.
TEST(NearEdgeFactor, KeepsItsDigitsDownToTheSmallestDistances) {
  const Vec3 a{-1, -1, 0}, b{1, 3, 0};  // passes through (-0.5, 0, 0) in the plane z = 0
  for (const double angle : {0.1, 0.7, 1.5, 2.9, -0.4, -2.0}) {
    const auto argument = [&](double distance) {
      // In the plane through (-0.5, 0, 0) spanned by y and z, coordinates relative to y = z = 0 are exact at any
      // magnitude.
      const Vec3 q{-0.5, distance * std::cos(angle), distance * std::sin(angle)};
      const Factor<double> f = near_edge_factor<double>(a, b, q).factor;
      return in_turns(f);
    };
    const double reference = argument_by_definition(a, b, {-0.5, 1e-8 * std::cos(angle), 1e-8 * std::sin(angle)});
    // 1e-3: at 1e-8 edge lengths cancellation leaves the reference 64 - 53 bits.
    EXPECT_NEAR(argument(1e-8), reference, 1e-3);
    const double limit = argument(1e-40);
    for (const double distance : {1e-20, 1e-60, 1e-100, 1e-200, 1e-300}) {
      EXPECT_NEAR(argument(distance), limit, 1e-15) << distance;
    }
    EXPECT_NEAR(argument(1e-12), limit, 1e-11);  // the first-order term of the distance
  }
}

// Of an edge that is level with the query, the argument is half the angle between the directions to its ends, where
// |a||b| and the product of both cancel.
TEST(NearEdgeFactor, IsWithinItsErrorWhereAnEdgeIsLevelAndSeenAsShort) {
  for (const double angle : {1e-6, 1e-8, 1e-10, 1e-12, 1e-14}) {
    const Vec3 a{0, 1.23, 1.23 * angle}, b{0, 1.69, -0.78 * angle};
    const NearEdgeFactor<Quad> f = near_edge_factor<Quad>(a, b, {0, 0, 0});
    const Quad tangent = (Quad(a.y) * b.z - Quad(a.z) * b.y) / (Quad(a.y) * b.y + Quad(a.z) * b.z);
    const Quad square = tangent * tangent;
    const Quad of_half = tangent / 2 * (1 - square / 4 + square * square / 8);  // what follows is below 1e-36 of it
    EXPECT_LE(absolute(f.factor.im / f.factor.re - of_half), f.error) << angle;
    EXPECT_LT(f.error, Quad(1e-31));
  }
}

TEST(NearEdgeFactor, MagnitudesOfCoordinatesDoNotMatter) {
  const Vec3 a{0.25, -1, 0.5}, b{0.5, 3, 0.25}, q{0.125, 0.75, 0.5};
  const Factor<double> expected = near_edge_factor<double>(a, b, q).factor;
  for (const double scale : {0x1p-1000, 0x1p-500, 0x1p500, 0x1p1000}) {
    const Factor<double> f = near_edge_factor<double>(scale * a, scale * b, scale * q).factor;
    EXPECT_EQ(f.re, expected.re);
    EXPECT_EQ(f.im, expected.im);
  }
}

}  // namespace
}  // namespace raycone
