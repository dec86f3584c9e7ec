#include "core/arrangement/effort.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/machine/threads.h"

namespace raycone {
namespace {

// Takes n steps for each n below `count`, of `steps`. What is left, or -1 where that is too much.
std::int64_t left_after(std::size_t count, std::uint64_t steps, int threads) {
  const ThreadLimit limit(threads);
  Effort effort(steps);
  const bool is_done = parallel_for_each(
      count, effort, [](std::size_t n, Effort& own) { return own.take(n / 2) && own.take(n - n / 2); });
  return is_done ? static_cast<std::int64_t>(effort.left()) : -1;
}

TEST(Effort, IsOfAllTogether) {
  for (const int threads : {1, 2, 7}) {
    EXPECT_EQ(left_after(100, 5000, threads), 50);
    EXPECT_EQ(left_after(100, 4951, threads), 1);
    EXPECT_EQ(left_after(100, 4950, threads), -1);  // each alone has enough
    EXPECT_EQ(left_after(100, 99, threads), -1);    // the last one has not
    EXPECT_EQ(left_after(0, 1, threads), 1);
  }
}

TEST(Effort, StopsWhereAllIsInVain) {
  const ThreadLimit limit(1);
  Effort effort(10);
  std::vector<std::size_t> done;
  EXPECT_FALSE(parallel_for_each(100, effort, [&](std::size_t n, Effort& own) {
    done.push_back(n);
    return own.take(6);
  }));
  EXPECT_EQ(done.size(), 2U);
}

TEST(Effort, DoesNotGoOnAfterWorkThatFails) {
  Effort effort(1000);
  EXPECT_FALSE(parallel_for_each(10, effort, [&](std::size_t n, Effort&) { return n != 5; }));
}

}  // namespace
}  // namespace raycone
