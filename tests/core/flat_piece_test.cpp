#include "core/boundary/flat_piece.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/shapes.h"

namespace raycone {
namespace {

// Points of pieces, in small boxes around them and in boxes that they are on the faces of.
TEST(FlatPiece, MeetsTheBoxesThatItsPointsAreIn) {
  test::Random random(9);
  const Box unit{{0, 0, 0}, {1, 1, 1}};
  int missed = 0;
  for (int i = 0; i < 3000; ++i) {
    const double scale = std::pow(2.0, std::floor(test::uniform(random, -30, 1)));
    const Vec3 shift = i % 3 ? test::uniform_point(random, unit) : Vec3{};
    const auto corner = [&] {  // some in one plane along the axes
      Vec3 p = scale * test::uniform_point(random, unit);
      if (i % 5 == 0) p.z = 0.0;
      return shift + p;
    };
    const Vec3 a = corner(), b = corner(), c = i % 7 ? corner() : 0.5 * (a + b);
    const FlatPiece piece = FlatPiece::of_triangle(a, b, c, box_of(a, b, c));
    const FlatPiece cone = FlatPiece::cone_of(a, b);
    for (int j = 0; j < 20; ++j) {
      const double u = test::uniform(random, 0, 1), v = (1 - u) * test::uniform(random, 0, 1);
      Vec3 on_triangle = (1 - u - v) * a + u * b + v * c, on_cone = (1 - u) * a + u * b;
      on_cone.x -= scale * v;
      // Up to rounding, these are of the pieces: a box is that much larger.
      const double error = 4 * 0x1p-52 * (scale + 1);
      const Vec3 sides = scale * std::pow(10.0, test::uniform(random, -6, 0)) * test::uniform_point(random, unit);
      const double share = j % 4 == 0 ? 0.0 : j % 4 == 1 ? 1.0 : test::uniform(random, 0, 1);
      const auto box_around = [&](const Vec3& p) {
        const Vec3 e{error, error, error};
        return Box{p - share * sides - e, p + (1 - share) * sides + e};
      };
      EXPECT_TRUE(piece.may_meet(box_around(on_triangle)));
      EXPECT_TRUE(cone.may_meet(box_around(on_cone)));
      const Vec3 elsewhere = shift + scale * test::uniform_point(random, unit);
      missed += !piece.may_meet(Box{elsewhere, elsewhere + 0.01 * sides});
    }
  }
  EXPECT_GT(missed, 40'000);
}

// Their products with normals do, as far as they are not 0.
TEST(FlatPiece, MeetsPointsSoCloseToACornerThatProductsUnderflow) {
  test::Random random(10);
  const Box unit{{0, 0, 0}, {1, 1, 1}};
  for (int i = 0; i < 1000; ++i) {
    const auto edge = [&] {  // of few bits, so that a multiple of it is on it exactly
      const Vec3 p = 1024 * test::uniform_point(random, unit);
      return 0x1p-209 * Vec3{std::floor(p.x), std::floor(p.y), std::floor(p.z)};
    };
    const Vec3 b = edge(), c = edge();
    const FlatPiece piece = FlatPiece::of_triangle({}, b, c, box_of({}, b, c));
    for (int exponent = -400; exponent > -840; --exponent) {
      const Vec3 p = std::ldexp(1.0, exponent) * b;
      EXPECT_TRUE(piece.may_meet({p, p})) << exponent;
    }
  }
}

}  // namespace
}  // namespace raycone
