// Boxes that meet must be found, whatever their sizes; and soon.
#include "core/cells/cell_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::Random;
using test::uniform;

Lattice lattice_of(std::int64_t side) { return {{-0.3, 0.2, 0.1}, {1, 1, 1}, {-1, 2, 0}, {side, side, side - 3}}; }

// Of sizes from less than a cell to the lattice's; some reach beyond it.
Box random_box(Random& random, std::int64_t cells) {
  const auto side = static_cast<double>(cells);
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = uniform(random, -4.0, side + 4.0);
    box.upper[axis] = box.lower[axis] + std::exp2(uniform(random, -3.0, std::log2(side)));
  }
  return box;
}

CellSet::Range range_of(const CellSet& cells, const Box& box) {
  const CellSet::Cell lower = cells.cell_of(box.lower), upper = cells.cell_of(box.upper);
  return CellSet::range_of(lower, upper, upper);
}

// What is beyond the lattice counts as on its border.
Box within(const Lattice& lattice, Box box) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const double first = lattice.coordinate(axis, lattice.index_min[a]);
    const double last = first + static_cast<double>(lattice.counts[a] - 1);
    box.lower[axis] = std::clamp(box.lower[axis], first, last);
    box.upper[axis] = std::clamp(box.upper[axis], first, last);
  }
  return box;
}

double gap_between(const Box& a, const Box& b) {
  double gap = 0.0;
  for (int axis = 0; axis < 3; ++axis)
    gap = std::max({gap, a.lower[axis] - b.upper[axis], b.lower[axis] - a.upper[axis]});
  return gap;
}

TEST(CellSet, FindsBoxesThatMeetAndNoneThatAreFar) {
  Random random(1);
  int met = 0, far = 0;
  for (const std::int64_t side : {5, 8, 17, 64, 75, 150, 300}) {
    for (int round = 0; round < 50; ++round) {
      CellSet cells(lattice_of(side));
      const Box box = random_box(random, side);
      cells.insert(range_of(cells, box));
      for (int n = 0; n < 100; ++n) {
        const Box other = random_box(random, side);
        const bool meets = cells.meets(range_of(cells, other));
        const Box a = within(lattice_of(side), box), b = within(lattice_of(side), other);
        if (gap_between(box, other) <= 0.0) {
          ASSERT_TRUE(meets) << side << " " << round;
          ++met;
        } else if (gap_between(a, b) > 2.0 + std::max(longest_side(a), longest_side(b))) {
          ASSERT_FALSE(meets) << side << " " << round;
          ++far;
        }
      }
    }
  }
  EXPECT_GT(met, 200);
  EXPECT_GT(far, 1000);
}

// A cell at a time, that would be a hundred billion.
TEST(CellSet, TakesLargeBoxesInLittleTime) {
  constexpr std::int64_t kSide = 512;
  CellSet cells(lattice_of(kSide));
  const CellSet::Cell last{kSide - 1, kSide - 1, kSide - 8};
  for (std::int32_t n = 0; n < 2000; ++n) {
    cells.insert(CellSet::range_of({n % 8, 0, 0}, last, last));
    EXPECT_TRUE(cells.meets(CellSet::range_of({0, n % 8, 0}, last, last)));
  }
}

}  // namespace
}  // namespace raycone
