// SIMD levels of the processor. No value depends on them.
#pragma once

#include <cstddef>

namespace raycone {

inline constexpr std::size_t kMostLanes = 8;  // doubles in the widest vector

// A count rounded up, so that vectors of any level end where it does.
[[nodiscard]] constexpr std::size_t padded_to_lanes(std::size_t count) {
  return (count + kMostLanes - 1) / kMostLanes * kMostLanes;
}

enum class SimdLevel {
  kBest,  // the best one that this processor has
  kSse4,
  kAvx2,
  kAvx512,
};

// Whether this processor has the level (and the compiler knew it).
[[nodiscard]] bool is_available(SimdLevel level);

// `wanted` if it is available, else the best available level. kBest if the processor has none of them.
[[nodiscard]] SimdLevel available_level(SimdLevel wanted);

}  // namespace raycone
