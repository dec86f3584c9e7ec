#include "core/boundary/change_bound.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/mesh/weld.h"
#include "tests/support/direct_winding_number.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

// Between places of a box the winding number changes by integers, and by what the bound says. So do its differences of
// any order: their coefficients are integers.
TEST(ChangeBound, HoldsBetweenAllPlaces) {
  test::Random random(6);
  std::array<int, kChangeOrders> tried{};
  std::array<double, kChangeOrders> largest{};  // part of the bound that was reached
  for (int i = 0; i < 60; ++i) {
    TriangleMesh mesh = i % 2 ? weld(test::soup(random, 5), {}) : test::open_box();
    if (i % 6 == 1) mesh = test::moved(mesh, {1, 0.01, 0.01}, {0, 0.5, 0.5});  // slender ones
    const ChangeBound bound(make_caps(Boundary(mesh), i % 4 < 2 ? 0.0 : 100.0));
    for (int j = 0; j < 20; ++j) {
      const Vec3 a = test::uniform_point(random, {{-0.5, -0.5, -0.5}, {1.5, 1.5, 1.5}});
      const double size = std::pow(10.0, test::uniform(random, -3, 0));
      const Vec3 b = a + size * test::uniform_point(random, {{0, 0, 0}, {1, 1, 1}});
      const ChangeSums most = bound.derivatives_in({a, b});
      EXPECT_EQ(bound.gradient_in({a, b}, 1e-30), std::numeric_limits<double>::infinity());
      if (most[0] < 1e6) {
        EXPECT_NEAR(bound.gradient_in({a, b}, 1e6), most[0], 1e-5 * most[0]);
      }
      const auto beside_integers = [](double w) { return std::abs(w - std::nearbyint(w)); };
      double factorial = 1.0;
      for (std::size_t order = 1; order <= kChangeOrders; ++order) {
        factorial *= static_cast<double>(order);
        const Vec3 step = (1.0 / static_cast<double>(order)) * (b - a);
        const double allowed = factorial * most[order - 1] * std::pow(norm(step), static_cast<double>(order));
        if (!(allowed > 1e-6 && allowed < 0.5)) continue;  // not rounding alone
        double difference = 0.0, binomial = 1.0;
        for (std::size_t n = 0; n <= order; ++n) {
          difference += binomial * test::direct_winding_number(mesh, a + static_cast<double>(n) * step);
          binomial *= -static_cast<double>(order - n) / static_cast<double>(n + 1);
        }
        EXPECT_LE(beside_integers(difference), allowed) << "order " << order;
        largest[order - 1] = std::max(largest[order - 1], beside_integers(difference) / allowed);
        ++tried[order - 1];
      }
    }
  }
  for (std::size_t order = 1; order <= kChangeOrders; ++order) {
    EXPECT_GT(tried[order - 1], 50) << "order " << order;
    EXPECT_GT(largest[order - 1], 0.02) << "the bound of order " << order << " is far off";
  }
}

// Its halves are as slender, and two of three sides of theirs as long as before: halved again and again, they would be
// some hundred.
TEST(ChangeBound, CutsSlenderCapsIntoFewPieces) {
  const TriangleMesh hair{{{0, 0, 0}, {1, 1, 0}, {1, 1, 1e-4}}, {{0, 1, 2}}};
  const ChangeBound bound(make_caps(Boundary(hair), 0.0));
  EXPECT_GT(bound.wide_caps().size(), 16U);
  EXPECT_LT(bound.wide_caps().size(), 80U);
}

// The four edges of length 1 around an opening.
TEST(ChangeBound, KnowsThatALoopCancelsFromAfar) {
  const ChangeBound bound(make_caps(Boundary(test::open_box()), 0.0));
  const double length = 4.0;
  for (const double distance : {8.0, 64.0, 512.0}) {
    const Vec3 q{distance, 0.5, 0.5};
    const double of_edges = length / (4 * std::numbers::pi * distance * distance);
    const double gradient = bound.gradient_in({q, q}, 1.0);
    EXPECT_LT(gradient, 4 / distance * of_edges);
    EXPECT_GT(gradient, 0.25 / distance * of_edges);  // a dipole, not nothing
  }
}

// Sources next to samples, in units of the mesh: the third power of the distance loses its bits, or is 0.
TEST(ChangeBound, IsNeverLessBecauseDistancesAreTiny) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity(), kArea = 0x1p-1000;
  ChangeNode node{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    node.lower[a].fill(kInfinity);  // nothing
    node.upper[a].fill(kInfinity);
    node.lower[a][0] = node.upper[a][0] = 0.0;
  }
  node.far_square.fill(-1.0);
  node.area[0] = kArea;
  int finite = 0;
  for (const SimdLevel level : {SimdLevel::kSse4, SimdLevel::kAvx2, SimdLevel::kAvx512}) {
    for (double d = 0x1p-480; d < 0x1p-300; d *= 1.07) {
      const double gradient = change_kernel(level).gradient({&node, 1}, {{d, 0, 0}, {d, 0, 0}}, kInfinity);
      const long double expected = static_cast<long double>(kArea) / d / d / d;  // whose exponents have more bits
      EXPECT_GE(gradient, expected * (1 - 1e-12L)) << d;
      finite += std::isfinite(gradient);
    }
  }
  EXPECT_GT(finite, 500);
}

// The squares of the areas of its caps underflow, which leaves the caps what they add.
TEST(ChangeBound, OfATinyLoopIsThatOfALargeOneInScale) {
  constexpr double kScale = 0x1p-280;
  TriangleMesh mesh = test::open_box();
  const ChangeBound large(make_caps(Boundary(mesh), 100.0));
  for (Vec3& p : mesh.vertices) p = kScale * p;
  const ChangeBound tiny(make_caps(Boundary(mesh), 100.0 * kScale));
  for (const double distance : {2.0, 8.0, 64.0}) {
    const Vec3 q{distance, 0.5, 0.5};
    const double expected = large.gradient_in({q, q}, 1e9);
    EXPECT_GT(expected, 0.0);
    EXPECT_NEAR(kScale * tiny.gradient_in({kScale * q, kScale * q}, 1e9 / kScale), expected, 1e-9 * expected);
  }
}

TEST(ChangeBound, IsTheSameForAllSimdLevels) {
  test::Random random(8);
  const Caps caps = make_caps(Boundary(weld(test::soup(random, 40), {})), 0.05);
  const ChangeBound best(caps);
  for (const SimdLevel level : {SimdLevel::kSse4, SimdLevel::kAvx2, SimdLevel::kAvx512}) {
    const ChangeBound bound(caps, level);
    for (int i = 0; i < 200; ++i) {
      const Vec3 a = test::uniform_point(random, {{-1, -1, -1}, {2, 2, 2}});
      const Box box{a, a + 0.01 * test::uniform_point(random, {{0, 0, 0}, {1, 1, 1}})};
      EXPECT_EQ(bound.gradient_in(box, 1e9), best.gradient_in(box, 1e9));
      EXPECT_EQ(bound.derivatives_in(box), best.derivatives_in(box));
    }
  }
}

}  // namespace
}  // namespace raycone
