// What sums and products round.
#pragma once

namespace raycone {

// Of some hundreds of numbers, at most, relative to the sum of their magnitudes: 1e-12 is 9000 roundings.
inline constexpr double kSumsRound = 1e-12;

}  // namespace raycone
