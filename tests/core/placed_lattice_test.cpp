// Lattices whose axes point anywhere.
#include "core/data/placed_lattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/evaluation/winding_number.h"
#include "tests/support/shapes.h"
#include "tests/support/values.h"

namespace raycone::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The six orders of the world's axes in all eight directions.
std::vector<std::array<Vec3, 3>> signed_permutations(const Vec3& spacing) {
  std::vector<std::array<Vec3, 3>> all;
  std::array<int, 3> axes{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      std::array<Vec3, 3> steps;
      for (std::size_t a = 0; a < 3; ++a) {
        const double length = spacing[static_cast<int>(a)];
        steps[a][axes[a]] = (signs >> a & 1) != 0 ? -length : length;
      }
      all.push_back(steps);
    }
  } while (std::next_permutation(axes.begin(), axes.end()));
  return all;
}

std::vector<Vec3> positions_of(const PlacedLattice& lattice, const LatticeBlock& block) {
  std::vector<Vec3> positions;
  for (std::size_t n = 0; n < static_cast<std::size_t>(block.size()); ++n) {
    positions.push_back(lattice.position(block, n));
  }
  return positions;
}

TEST(PlacedLattice, ALatticeAlongTheAxesIsItself) {
  const Lattice lattice{{0.1, -7, 1e9}, {0.3, 0.7, 1e-3}, {-3, 2, 5}, {4, 5, 6}};
  const PlacedLattice placed = lattice;
  EXPECT_TRUE(placed.along_axes());
  EXPECT_EQ(placed.direction(), (std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
  for (std::int64_t i = -3; i <= 0; ++i) {
    EXPECT_EQ(placed.position(i, 4, 9), (Vec3{lattice.coordinate(0, i), lattice.coordinate(1, 4), 1e9 + 9 * 1e-3}));
  }
  const LatticeBlock block{{-2, 3, 6}, {2, 3, 4}};
  EXPECT_EQ(placed.position(block, 2 * 3 * 1 + 2 * 2 + 1), placed.position(-1, 5, 7));
}

// The box has faces on samples: a tie that goes the wrong way shows.
TEST(PlacedLattice, TheOrderOfTheAxesChangesNoValue) {
  for (const TriangleMesh& mesh : {box_mesh({0, 0, 0}, {1, 1, 1}), open_box()}) {
    const WindingNumberEvaluator evaluator(mesh);
    for (const std::array<Vec3, 3>& steps : signed_permutations({0.5, 0.25, 0.125})) {
      const Vec3 middle{0.5, 0.5, 0.5};
      const Vec3 origin = middle - (2.0 * steps[0] + 3.0 * steps[1] + 4.0 * steps[2]);
      const PlacedLattice lattice(origin, steps, {1, -1, 0}, {4, 7, 9});
      const std::optional<WorldOrder> order = world_order(lattice);
      ASSERT_TRUE(order);
      const LatticeBlock block{{2, 0, 1}, {3, 5, 7}};  // a part of it
      const LatticeBlock world = order->block_of(block);
      std::vector<double> values(static_cast<std::size_t>(world.size()));
      evaluator.evaluate(order->lattice, world, values);
      const std::vector<Vec3> positions = positions_of(lattice, block);
      const std::vector<double> expected = values_of(evaluator, positions);
      const WorldOrder::Walk walk = order->walk(block);
      for (std::size_t n = 0; n < expected.size(); ++n) {
        const auto number = static_cast<std::int64_t>(n);
        const std::int64_t from = walk.start + number % 3 * walk.strides[0] + number / 3 % 5 * walk.strides[1] +
                                  number / 15 * walk.strides[2];
        ASSERT_EQ(values.at(static_cast<std::size_t>(from)), expected[n]) << n;
      }
    }
  }
}

TEST(PlacedLattice, OtherAxesHaveNoOrder) {
  EXPECT_FALSE(world_order(PlacedLattice({}, {{{1, 1e-300, 0}, {0, 1, 0}, {0, 0, 1}}}, {}, {2, 2, 2})));
  EXPECT_FALSE(world_order(PlacedLattice({}, {{{1, 0, 0}, {2, 0, 0}, {0, 0, 1}}}, {}, {2, 2, 2})));
  EXPECT_FALSE(world_order(PlacedLattice({}, {{{1, 0, 0}, {0, 0, 0}, {0, 0, 1}}}, {}, {2, 2, 2})));
}

TEST(PlacedLattice, IndicesAreThoseOfThePlace) {
  Random random(1);
  int tried = 0;
  for (int repeat = 0; repeat < 100; ++repeat) {
    const Box box{{-1, -1, -1}, {1, 1, 1}};
    std::array<Vec3, 3> steps;
    for (Vec3& step : steps) step = uniform_point(random, box);
    const PlacedLattice lattice(uniform_point(random, box), steps, {-5, 0, 2}, {9, 9, 9});
    if (std::abs(lattice.signed_volume()) < 1e-3) continue;
    ++tried;
    const Vec3 indices = indices_of(lattice, lattice.position(-3, 4, 7));
    // Rounding of places, some 3e-15 of 20, times the inverse: products of two steps, up to 3, over a volume of 1e-3.
    // And as much for the roundings of these products, and of the volume.
    EXPECT_NEAR(indices.x, -3, 1e-10);
    EXPECT_NEAR(indices.y, 4, 1e-10);
    EXPECT_NEAR(indices.z, 7, 1e-10);
  }
  EXPECT_GT(tried, 90);
}

TEST(PlacedLattice, BoxHoldsAllSamples) {
  const PlacedLattice lattice({1, 2, 3}, {{{1, 0.5, 0}, {-0.5, 1, 0}, {0.25, 0, -2}}}, {-1, 0, 0}, {3, 4, 5});
  const Box box = box_of(lattice);
  EXPECT_EQ(box.lower, (Vec3{1 - 1 - 1.5, 2 - 0.5, 3 - 8.0}));
  EXPECT_EQ(box.upper, (Vec3{1 + 1 + 1.0, 2 + 0.5 + 3, 3}));
}

TEST(PlacedLattice, TellsWhatIsNoLattice) {
  const auto lattice_of = [](const std::array<Vec3, 3>& steps, const Vec3& origin = {}) {
    return PlacedLattice(origin, steps, {0, 0, 0}, {10, 10, 10});
  };
  for (const double size : {1e-300, 1.0, 1e300}) {
    EXPECT_TRUE(lattice_of({{{size, 0, 0}, {0, size, size}, {0, 0, -size}}}).spans_space()) << size;
    EXPECT_FALSE(lattice_of({{{size, 0, 0}, {0, size, 0}, {size, size, 0}}}).spans_space()) << size;
    EXPECT_FALSE(lattice_of({{{size, 0, 0}, {0, size, 0}, {0, 0, 0}}}).spans_space()) << size;
  }
  EXPECT_FALSE(lattice_of({{{0.1, 0.2, 0.3}, {0.4, 0.5, 0.6}, {0.7, 0.8, 0.9}}}).spans_space());
  EXPECT_FALSE(lattice_of({{{NAN, 0, 0}, {0, 1, 0}, {0, 0, 1}}}).spans_space());
  EXPECT_FALSE(lattice_of({{{kInfinity, 0, 0}, {0, 1, 0}, {0, 0, 1}}}).is_finite());
  EXPECT_FALSE(lattice_of({{{1e307, 0, 0}, {9e307, 1, 0}, {0, 0, 1}}}).is_finite());
  // The sum is finite, but not on the way to it.
  EXPECT_FALSE(lattice_of({{{1.5e307, 0, 0}, {-1.5e307, 1e307, 0}, {0, 0, 1}}}, {1e308, 0, 0}).is_finite());
  EXPECT_TRUE(lattice_of({{{1e306, 0, 0}, {-1e306, 1, 0}, {0, 0, 1}}}, {1e308, 0, 0}).is_finite());
}

TEST(PlacedLattice, TellsWhichVoxelsAreCubic) {
  const double c = std::cos(0.3), s = std::sin(0.3);
  const auto turned = [&](double stretch, double skew) {
    return PlacedLattice({}, {{{c, s, 0}, {-s * stretch, c * stretch, skew}, {0, 0, -1}}}, {}, {2, 2, 2});
  };
  EXPECT_TRUE(turned(1, 0).is_cubic(1e-15));
  EXPECT_TRUE(turned(1, 1e-6).is_cubic(1e-5));
  EXPECT_FALSE(turned(1, 1e-4).is_cubic(1e-5));
  EXPECT_TRUE(turned(1 + 1e-6, 0).is_cubic(1e-5));
  EXPECT_FALSE(turned(1 + 1e-4, 0).is_cubic(1e-5));
  EXPECT_TRUE(turned(2, 0).is_orthogonal(1e-5));
}

}  // namespace
}  // namespace raycone::test
