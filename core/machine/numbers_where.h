// The numbers for which something holds, found on all threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/machine/first_touch.h"
#include "core/machine/threads.h"

namespace raycone {

// Those below `count` for which holds(number), in increasing order. `holds` is asked twice, on any thread.
// Precondition: count <= 2^32.
template <class Holds>
[[nodiscard]] std::vector<std::uint32_t> numbers_where(std::size_t count, const Holds& holds) {
  constexpr std::size_t kChunk = std::size_t{1} << 15;
  const std::size_t chunks = (count + kChunk - 1) / kChunk;
  std::vector<std::size_t> places(chunks + 1, 0);
  const auto for_each_chunk = [&](const auto& visit) {
    parallel_for_each(chunks, [&](std::size_t chunk) {
      for (std::size_t n = chunk * kChunk; n < std::min(count, (chunk + 1) * kChunk); ++n) {
        if (holds(static_cast<std::uint32_t>(n))) visit(chunk, static_cast<std::uint32_t>(n));
      }
    });
  };
  for_each_chunk([&](std::size_t chunk, std::uint32_t) { ++places[chunk + 1]; });
  for (std::size_t chunk = 0; chunk < chunks; ++chunk) places[chunk + 1] += places[chunk];
  auto numbers = sized_on_all_threads<std::uint32_t>(places.back());
  for_each_chunk([&](std::size_t chunk, std::uint32_t n) { numbers[places[chunk]++] = n; });
  return numbers;
}

}  // namespace raycone
