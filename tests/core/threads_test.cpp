#include "core/machine/threads.h"

#include <gtest/gtest.h>
#include <xmmintrin.h>

#include <atomic>
#include <cstddef>
#include <functional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "core/machine/floating_point.h"

namespace raycone {
namespace {

constexpr std::size_t kCount = 10000;

TEST(ParallelFor, CoversEachItemOnce) {
  std::vector<std::atomic<int>> visits(kCount);
  parallel_for(kCount, 7, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) ++visits[n];
  });
  for (const std::atomic<int>& count : visits) EXPECT_EQ(count, 1);
}

TEST(ParallelFor, CallsABodyOfItemsForEachOnce) {
  std::vector<std::atomic<int>> visits(kCount);
  parallel_for_each(kCount, [&](std::size_t n) { ++visits[n]; });
  for (const std::atomic<int>& count : visits) EXPECT_EQ(count, 1);
  parallel_for_each(0, [&](std::size_t) { ADD_FAILURE() << "of nothing"; });
}

// TBB gives its tasks the environment in which a thread first called it, so that a thread of our own is needed.
TEST(ParallelFor, RunsInTheDefaultFloatingPointEnvironment) {
  std::atomic<std::size_t> elsewhere{0};
  std::thread flushing([&] {
    const unsigned flushes = _mm_getcsr() | 0x8040U;
    _mm_setcsr(flushes);
    parallel_for(kCount, 1, [&](std::size_t begin, std::size_t end) {
      if (!DefaultFloatingPoint::holds()) elsewhere += end - begin;
    });
    EXPECT_EQ(_mm_getcsr() & 0xFFC0U, flushes & 0xFFC0U) << "the caller's own, but for the flags of exceptions";
  });
  flushing.join();
  EXPECT_EQ(elsewhere, 0U);
}

TEST(ParallelFor, PassesExceptionsOn) {
  const auto fail = [](std::size_t, std::size_t) { throw std::range_error("of the body"); };
  EXPECT_THROW(parallel_for(kCount, 1, fail), std::range_error);
}

// What TBB says where it cannot start a thread begins like this, and so may a file's name.
TEST(ParallelFor, TakesNoExceptionOfItsBodyForALackOfThreads) {
  const auto fail = [](std::size_t, std::size_t) {
    throw std::runtime_error("pthread_create.obj:3: expected a number");
  };
  const auto nested = [&fail](std::size_t, std::size_t) { parallel_for(kCount, 1, fail); };
  for (const std::function<void(std::size_t, std::size_t)>& body :
       std::vector<std::function<void(std::size_t, std::size_t)>>{fail, nested}) {
    try {
      parallel_for(kCount, 1, body);
      ADD_FAILURE() << "no exception";
    } catch (const std::exception& error) {
      EXPECT_STREQ(error.what(), "pthread_create.obj:3: expected a number");
    }
  }
}

}  // namespace
}  // namespace raycone
