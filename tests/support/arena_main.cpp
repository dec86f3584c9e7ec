// main() of the tests: all of them run in an arena of at least eight threads, whatever the machine has. Loops within
// loops hang where threads wait for one another; of two threads that is hardly ever seen.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  constexpr int kLeastThreads = 8;
  const int threads = std::max(kLeastThreads, tbb::info::default_concurrency());
  const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  return arena.execute([] { return RUN_ALL_TESTS(); });
}
