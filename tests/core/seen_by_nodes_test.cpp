#include "core/filling/seen_by_nodes.h"

#include <gtest/gtest.h>

#include "core/cells/node_set.h"
#include "core/data/lattice.h"

namespace raycone {
namespace {

// What is judged at parts of triangles, at all places of a lattice.
TEST(SeenByNodes, TellsHowFarTrianglesAreFromNodesOfBothKinds) {
  const Lattice lattice{{0, 0, 0}, {1, 1, 1}, {0, 0, 0}, {30, 30, 30}};
  NodeSet inside(lattice);
  inside.insert(15, 15, 15);
  const auto is_seen = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    return sights_of(inside, {{{0, 1, 2}}}, {a, b, c}).front() == Sight::kWhole;
  };
  const Vec3 at{15, 15, 15};
  for (double far = 0.0; far < 14.0; far += 0.5) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {-1.0, 1.0}) {
        Vec3 to = at;
        to[axis] += sign * far;
        const Vec3 beside = to + Vec3{0.1, 0.1, 0.1};
        const bool seen = is_seen(at, to, beside);
        if (far <= 4.0) {
          EXPECT_TRUE(seen) << far << ' ' << axis;
        }
        if (far >= 11.0) {  // eight and a cell, and half of a part
          EXPECT_FALSE(seen) << far << ' ' << axis;
        }
      }
    }
  }
  EXPECT_FALSE(is_seen({17.5, 15, 15}, {18, 15, 15}, {17.5, 16, 15}));  // near, but in no such cell
  EXPECT_TRUE(is_seen({16.5, 15, 15}, {15.5, 15, 15}, {15.5, 16, 15}));
  for (const double beyond : {-1e-9, 29.001, 1e300})
    EXPECT_FALSE(is_seen(at, {15, beyond, 15}, {16, 15, 15})) << beyond;
}

}  // namespace
}  // namespace raycone
