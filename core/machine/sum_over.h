// A sum on all threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "core/machine/threads.h"

namespace raycone {

// Of value(n), converted to std::uint64_t, for each n below `count`. `value` is asked on any thread.
template <class Value>
[[nodiscard]] std::uint64_t sum_over(std::size_t count, const Value& value) {
  constexpr std::size_t kGrain = 1024;
  std::atomic<std::uint64_t> sum = 0;
  parallel_for(count, kGrain, [&](std::size_t begin, std::size_t end) {
    std::uint64_t here = 0;
    for (std::size_t n = begin; n < end; ++n) here += static_cast<std::uint64_t>(value(n));
    sum += here;
  });
  return sum;
}

}  // namespace raycone
