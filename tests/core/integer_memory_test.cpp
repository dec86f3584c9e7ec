#include "core/exact/integer_memory.h"

#include <gmpxx.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <barrier>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <thread>
#include <vector>

namespace raycone {
namespace {

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // whose own allocators end the process

// Leaves the C library no block of any size.
void use_up_memory() {
  const rlimit none{0, 0};
  setrlimit(RLIMIT_DATA, &none);
  setrlimit(RLIMIT_AS, &none);
  for (std::size_t size = std::size_t{1} << 26; size > 0; size /= 2) {
    void* volatile block = nullptr;
    do {
      block = std::malloc(size);
    } while (block);
  }
}

// 3^2^n - 1 = (3^2^(n-1) - 1)(3^2^(n-1) + 1), numbers of up to 400 bytes, one of which grows.
bool multiplies_integers() {
  bool is_right = true;
  mpz_class power = 3;
  for (int n = 0; n < 11; ++n) {
    const mpz_class square = power * power;
    is_right = is_right && square - 1 == (power - 1) * (power + 1);
    power = square;
  }
  return is_right && mpz_sizeinbase(power.get_mpz_t(), 2) == 3247;
}

TEST(IntegerMemory, IsThereWhereTheCLibraryHasNone) {
  const auto run = [] {
    reserve_memory_for_integers();
    use_up_memory();
    for (int n = 0; n < 1000; ++n) {
      if (!multiplies_integers()) std::_Exit(1);
    }
    std::_Exit(0);
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(0), "");
}

// A block that two threads got, or that one lost, would be a wrong product.
TEST(IntegerMemory, IsSharedByThreads) {
  const auto run = [] {
    constexpr int kThreads = 8;
    reserve_memory_for_integers();
    std::atomic<bool> is_right = true;
    std::barrier all(kThreads);
    const auto multiply = [&] {
      all.arrive_and_wait();  // without memory no thread starts
      use_up_memory();        // that of the thread's own heap
      all.arrive_and_wait();
      for (int n = 0; n < 300; ++n) {
        if (!multiplies_integers()) is_right = false;
      }
    };
    std::vector<std::thread> threads(kThreads);
    for (std::thread& thread : threads) thread = std::thread(multiply);
    for (std::thread& thread : threads) thread.join();
    std::_Exit(is_right ? 0 : 1);
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(0), "");
}

TEST(IntegerMemory, IsMissedByGmpOtherwise) {
  const auto run = [] {
    use_up_memory();
    std::_Exit(multiplies_integers() ? 0 : 1);
  };
  EXPECT_EXIT(run(), testing::KilledBySignal(SIGABRT), "GNU MP: Cannot allocate memory");
}

#endif

}  // namespace
}  // namespace raycone
