// What sums and products round.
#pragma once

namespace raycone {

// Of a few numbers, at most, relative to the sum of their magnitudes: thousands of roundings.
inline constexpr double kSumsRound = 1e-12;

}  // namespace raycone
