#include "core/orientation/nesting_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/orientation/nesting.h"

namespace raycone {
namespace {

// Surfaces of one box: 1 in 2, 2 in 3, 3 in 1; 0 around all of them; 4 and 5 in 3, and in each other.
TEST(NestingTree, EndsCirclesWhateverTheOrder) {
  const std::vector<std::vector<std::uint32_t>> around{{}, {0, 2}, {0, 3}, {0, 1}, {0, 3, 5}, {0, 3, 4}};
  const std::vector<std::uint32_t> expected{0, 0, 3, 1, 3, 3};
  std::vector<Vec3> vertices{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {0.1, 0.1, 0.1}};
  for (double x = 0; x < 0.95; x += 0.1) vertices.push_back({x, 0.5, 0.5});
  const std::vector<Triangle> faces{{0, 2, 5}, {0, 1, 6}, {0, 1, 7}, {0, 1, 8}, {3, 1, 9}, {3, 1, 10}};
  std::vector<std::uint32_t> number{0, 1, 2, 3, 4, 5};
  do {
    std::vector<ClosedSurface> surfaces(6);
    std::vector<const ClosedSurface*> pointers(6);
    std::vector<std::vector<std::uint32_t>> renumbered(6);
    for (std::size_t i = 0; i < 6; ++i) {
      surfaces[i].faces = {faces[i]};
      pointers[number[i]] = &surfaces[i];
      for (const std::uint32_t outer : around[i]) renumbered[number[i]].push_back(number[outer]);
      std::ranges::sort(renumbered[number[i]]);
    }
    const NestingTree tree = nesting_tree(renumbered, pointers, vertices);
    ASSERT_EQ(tree.order.size(), 6U);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(tree.parent[number[i]], number[expected[i]]) << i;
  } while (std::ranges::next_permutation(number).found);
}

}  // namespace
}  // namespace raycone
