// What is refused for lack of memory, and what this machine has; memory_limit_test.py asks whether runs stay within
// their limit.
#include "app/process/memory_limit.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "io/files/file_error.h"
#include "tests/support/error_text.h"

namespace raycone::test {
namespace {

TEST(Memory, OfThisMachineIsSensible) {
  EXPECT_GT(available_memory(), 1'000'000U);
  EXPECT_GT(peak_memory(), 100'000U);
}

TEST(CheckMemory, NamesBothNumbers) {
  check_memory("a.obj", 0.0, std::uint64_t{1} << 40);
  const std::string refused =
      error_text<LimitError>([] { check_memory("a.obj", 34.0 * (1 << 30), std::uint64_t{8} << 30); });
  EXPECT_TRUE(refused.starts_with("a.obj: needs about 34 GB of memory, but the limit is 8 GB")) << refused;
}

}  // namespace
}  // namespace raycone::test
