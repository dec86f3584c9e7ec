// From coordinates to samples and cells.
#include "core/data/lattice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

namespace raycone::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// All numbers are exact.
const Lattice kBinary{{1, -2, 0}, {0.5, 0.25, 4}, {-3, 2, 0}, {4, 5, 6}};

TEST(Lattice, ItsMeasures) {
  EXPECT_EQ(kBinary.least_spacing(), 0.25);
  EXPECT_EQ(kBinary.largest_spacing(), 4.0);
  EXPECT_EQ(largest_coordinate(kBinary), 20.0);                                            // z of the last sample
  EXPECT_EQ(largest_coordinate(Lattice{{-9, 1, 2}, {1, 1, 1}, {0, 0, 0}, {4, 3, 2}}), 9);  // x of the first one
}

TEST(Lattice, AnIndexIsTheInverseOfACoordinate) {
  for (int axis = 0; axis < 3; ++axis) {
    for (std::int64_t i = -9; i < 9; ++i) {
      const double first = static_cast<double>(kBinary.index_min[static_cast<std::size_t>(axis)]);
      EXPECT_EQ(kBinary.index_at(axis, kBinary.coordinate(axis, i)), static_cast<double>(i));
      EXPECT_EQ(kBinary.steps_from_first(axis, kBinary.coordinate(axis, i)), static_cast<double>(i) - first);
    }
  }
  EXPECT_EQ(kBinary.index_at(0, 1.125), 0.25);
  EXPECT_EQ(kBinary.steps_from_first(0, 1.125), 3.25);
}

// An index of 2^40 leaves 12 bits for the part of a step.
TEST(Lattice, StepsFromAFarFirstSampleKeepTheirDigits) {
  const Lattice far{{0, 0, 0}, {0.1, 0.1, 0.1}, {std::int64_t{1} << 40, 0, 0}, {4, 4, 4}};
  const double first = far.coordinate(0, far.index_min[0]), next = std::nextafter(first, kInfinity);
  EXPECT_EQ(far.steps_from_first(0, first), 0.0);
  EXPECT_EQ(far.steps_from_first(0, next), (next - first) / 0.1);
}

TEST(Lattice, CellsAreHalfOpen) {
  EXPECT_EQ(kBinary.cell_at(2, std::nextafter(4.0, 0.0)), 0);
  EXPECT_EQ(kBinary.cell_at(2, 4.0), 1);
  EXPECT_EQ(kBinary.cell_at(1, -1.5), 0);
  EXPECT_EQ(kBinary.cell_at(1, -1.3), 0);
  EXPECT_EQ(kBinary.cell_of(2, 3.75), 3);
}

TEST(Lattice, WhatIsBeyondTheLatticeHasTheCellsAroundIt) {
  EXPECT_EQ(kBinary.cell_of(0, -3.0), 0);
  EXPECT_EQ(kBinary.cell_of(0, -3.25), -1);
  EXPECT_EQ(kBinary.cell_at(0, -1e300), -1);
  EXPECT_EQ(kBinary.cell_at(0, -kInfinity), -1);
  EXPECT_EQ(kBinary.cell_of(0, 0.75), 3);
  EXPECT_EQ(kBinary.cell_of(0, 1.0), 4);
  EXPECT_EQ(kBinary.cell_at(0, 1e300), 4);
  EXPECT_EQ(kBinary.cell_at(0, kInfinity), 4);
}

TEST(Lattice, OfTwoCoordinatesTheLargerOneHasNoSmallerIndex) {
  const Lattice lattice{{0.1, 0, 0}, {0.3, 1, 1}, {-5, 0, 0}, {20, 1, 1}};
  for (std::int64_t i = -5; i < 15; ++i) {
    const double at = lattice.coordinate(0, i), before = std::nextafter(at, -kInfinity);
    EXPECT_LE(lattice.index_at(0, before), lattice.index_at(0, at));
    EXPECT_LE(lattice.cell_at(0, before), lattice.cell_at(0, at));
    EXPECT_NEAR(lattice.index_at(0, at), static_cast<double>(i), 1e-14);  // some roundings of numbers up to 20
  }
}

}  // namespace
}  // namespace raycone::test
