// SplitMix64 (Steele, Lea, Flood 2014): numbers as if random, the same everywhere.
#pragma once

#include <cstdint>

namespace raycone {

inline constexpr std::uint64_t kSplitMixStep = 0x9E3779B97F4A7C15;  // from one state to the next

// The number of a state; one-to-one.
[[nodiscard]] constexpr std::uint64_t split_mix(std::uint64_t state) {
  state = (state ^ (state >> 30U)) * 0xBF58476D1CE4E5B9;
  state = (state ^ (state >> 27U)) * 0x94D049BB133111EB;
  return state ^ (state >> 31U);
}

}  // namespace raycone
