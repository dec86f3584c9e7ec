// Harmonic fits, what is certified of them, and what is made of their polynomials.
#include "core/far/harmonic_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

#include "core/far/harmonic_error.h"
#include "core/far/harmonic_polynomial.h"
#include "core/far/matrix_kernel.h"
#include "tests/support/differences.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::Random;

constexpr Cube kUnit{{0, 0, 0}, 1};

struct Dipole {
  Vec3 place, direction;

  [[nodiscard]] double operator()(const Vec3& q) const {
    const Vec3 r = q - place;
    const double square = dot(r, r);
    return dot(r, direction) / (4 * std::numbers::pi * square * std::sqrt(square));
  }
};

// On a face of the cube at the distance, of any direction.
Dipole dipole_at(Random& random, double distance) {
  Dipole dipole;
  do {
    for (int axis = 0; axis < 3; ++axis) dipole.direction[axis] = test::uniform(random, -1, 1);
  } while (dot(dipole.direction, dipole.direction) < 0.1);
  dipole.direction = (1 / std::sqrt(dot(dipole.direction, dipole.direction))) * dipole.direction;
  for (int axis = 0; axis < 3; ++axis) dipole.place[axis] = test::uniform(random, -distance, distance);
  dipole.place[static_cast<int>(random() % 3)] = random() % 2 == 0 ? distance : -distance;
  return dipole;
}

template <class Function>
Coefficients fit_of(const Function& f) {
  const HarmonicFit& fit = HarmonicFit::instance();
  std::vector<double> values(HarmonicFit::kNodes * HarmonicFit::kTogether);
  for (std::size_t n = 0; n < HarmonicFit::kNodes; ++n) values[n * HarmonicFit::kTogether] = f(fit.node(n));
  std::vector<Coefficients> polynomials(1);
  fit.fit(values, polynomials, matrix_kernel(SimdLevel::kBest));
  return polynomials[0];
}

// The largest difference on the cube, which a grid with its faces shows.
template <class Function>
double largest_error(const Coefficients& polynomial, const Function& f) {
  std::vector<double> along;
  for (int i = -8; i <= 8; ++i) along.push_back(i / 8.0);
  GridValues grid(matrix_kernel(SimdLevel::kBest));
  const auto values = grid.evaluate(polynomial, kDegree, kUnit, along, along, along);
  double largest = 0.0;
  for (std::size_t z = 0; z < along.size(); ++z) {
    for (std::size_t y = 0; y < along.size(); ++y) {
      for (std::size_t x = 0; x < along.size(); ++x) {
        const double value = values[(z * along.size() + y) * GridValues::row_size(along.size()) + x];
        largest = test::larger_difference(largest, std::abs(value - f(Vec3{along[x], along[y], along[z]})));
      }
    }
  }
  return largest;
}

TEST(HarmonicFitTest, ErrorsOfDipolesAreWithinTheTableAndNotFarBelow) {
  Random random(1);
  for (const double distance : {1.8, 2.2, 2.7, 3.3, 3.95}) {
    double largest = 0.0;
    for (int n = 0; n < 12; ++n) {
      const Dipole dipole = dipole_at(random, distance);
      largest = std::max(largest, largest_error(fit_of(dipole), dipole));
    }
    EXPECT_LE(largest, dipole_error(distance)) << distance;
    // A table that is of another fit would not be so close. Few dipoles are the worst there are.
    EXPECT_GE(largest, dipole_error(distance) / 8) << distance;
  }
  EXPECT_EQ(dipole_error(1.49), std::numeric_limits<double>::infinity());
}

TEST(HarmonicFitTest, HarmonicPolynomialsAreTheirOwnFits) {
  const auto harmonic = [](const Vec3& q) { return 0.3 + q.x * q.y * q.z + q.x * q.x - q.z * q.z; };
  EXPECT_LT(largest_error(fit_of(harmonic), harmonic), HarmonicFit::kRounding);
  const auto other = [](const Vec3& q) { return q.x * q.x; };
  EXPECT_GT(largest_error(fit_of(other), other), 1e-3);
}

TEST(HarmonicFitTest, RoundingAndGrowthAreAsDeclared) {
  Random random(2);
  for (int n = 0; n < 8; ++n) {
    const Dipole far = dipole_at(random, 40.0);  // its fit is off by rounding alone
    const auto f = [&](const Vec3& q) { return 1e4 * far(q); };
    double largest = 0.0;
    for (std::size_t i = 0; i < HarmonicFit::kNodes; ++i) {
      largest = std::max(largest, std::abs(f(HarmonicFit::instance().node(i))));
    }
    EXPECT_LT(largest_error(fit_of(f), f), HarmonicFit::kRounding * largest);
    const auto noise = [&](const Vec3&) { return random() % 2 == 0 ? 1.0 : -1.0; };
    const auto zero = [](const Vec3&) { return 0.0; };
    EXPECT_LT(largest_error(fit_of(noise), zero), HarmonicFit::kLargestWeights);
  }
}

TEST(HarmonicPolynomialTest, APartOfTheCubeHasTheSameValues) {
  Random random(3);
  const MatrixKernel multiply = matrix_kernel(SimdLevel::kBest);
  const Coefficients polynomial = fit_of(dipole_at(random, 2.0));
  const Cube part{{0.45, -0.5, 0.1}, 0.5};
  const std::vector<double> xs{-0.05, 0.3, 0.95}, ys{-1.0, -0.4}, zs{0.0, 0.1, 0.6};
  GridValues grid(multiply), grid_of_part(multiply);
  const auto whole = grid.evaluate(polynomial, kDegree, kUnit, xs, ys, zs);
  const auto same = grid_of_part.evaluate(on_cube(polynomial, kUnit, part, multiply), kDegree, part, xs, ys, zs);
  for (std::size_t i = 0; i < whole.size(); ++i) EXPECT_NEAR(whole[i], same[i], 1e-15);
}

// From block to block, down to the smallest ones. The first cube sticks out as far as any does: its block is 0.6 times
// as long along one axis as along the others, which are divided. The others are octants, a little larger.
TEST(HarmonicPolynomialTest, PartsOfPartsRoundLessThanFits) {
  Random random(7);
  const MatrixKernel multiply = matrix_kernel(SimdLevel::kBest);
  double largest = 0.0;  // relative to the largest value at the nodes
  for (int n = 0; n < 40; ++n) {
    const Dipole dipole = dipole_at(random, 1.6 + 0.1 * (n % 10));
    const Coefficients polynomial = fit_of(dipole);
    double most = 0.0;
    for (std::size_t i = 0; i < HarmonicFit::kNodes; ++i) {
      most = std::max(most, std::abs(dipole(HarmonicFit::instance().node(i))));
    }
    Coefficients part = polynomial;
    Cube cube = kUnit;
    GridValues grid(multiply), grid_of_part(multiply);
    for (int level = 1; level <= 16; ++level) {
      const auto side = [&] { return random() % 2 == 0 ? -0.5 : 0.5; };
      const bool sticks_out = level == 1 && n % 2 == 0;
      const Vec3 to_middle = cube.half * Vec3{side(), side(), sticks_out ? 0.0 : side()};
      const Cube next{cube.centre + to_middle, cube.half * (sticks_out ? 0.6 : 0.5) * (1.0 + 0x1.3p-9)};
      part = on_cube(part, cube, next, multiply);
      cube = next;
      std::vector<double> xs, ys, zs;
      for (const double at : {-0.8, -0.3, 0.2, 0.8}) {
        const Vec3 p = cube.centre + cube.half * Vec3{at, at, at};
        xs.push_back(p.x), ys.push_back(p.y), zs.push_back(p.z);
      }
      const auto whole = grid.evaluate(polynomial, kDegree, kUnit, xs, ys, zs);
      const auto same = grid_of_part.evaluate(part, kDegree, cube, xs, ys, zs);
      for (std::size_t i = 0; i < whole.size(); ++i) {
        if (i % GridValues::row_size(xs.size()) < xs.size())
          largest = test::larger_difference(largest, std::abs(whole[i] - same[i]) / most);
      }
    }
  }
  EXPECT_LT(largest, HarmonicFit::kRounding / 10);
  EXPECT_GT(largest, 1e-17) << "or nothing was compared";
}

TEST(HarmonicPolynomialTest, TruncationIsWithinItsBudget) {
  Random random(4);
  const Coefficients polynomial = fit_of(dipole_at(random, 3.0));
  const Truncation truncated = truncation(polynomial, 1e-6);
  EXPECT_LT(truncated.degree, kDegree);
  EXPECT_LE(truncated.dropped, 1e-6);
  const std::vector<double> along{-1.0, -0.3, 0.2, 1.0};
  const MatrixKernel multiply = matrix_kernel(SimdLevel::kBest);
  GridValues grid(multiply), shorter(multiply);
  const auto all = grid.evaluate(polynomial, kDegree, kUnit, along, along, along);
  const auto some = shorter.evaluate(polynomial, truncated.degree, kUnit, along, along, along);
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_NEAR(all[i], some[i], truncated.dropped + 1e-15);
}

}  // namespace
}  // namespace raycone
