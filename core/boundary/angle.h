// The argument of a complex number.
#pragma once

#include <array>

namespace raycone {

// The argument of re + i im in turns (units of 2 pi), in [-1/2, 1/2], with the sign bit of im. Not both 0. The relative
// error is below kArgumentError times u, half a unit in the last place of Real's 1. Our own, because the C library's
// atan2 rounds differently on CPUs with and without fused multiply-add.
inline constexpr int kArgumentError = 9;
template <class Real>  // double or long double
[[nodiscard]] Real argument_in_turns(Real re, Real im);

// Its constants, for core/boundary/product_lanes-inl.h, which does the same in SIMD lanes: atan(k / 8) / (2 pi) for k =
// 0 to 8, and 1 / (2 pi).
inline constexpr std::array<long double, 9> kArcTangentsInTurns = {
    0.0L,
    0.019791712080282771005425836L,
    0.038989565188684662730256445L,
    0.057100125609954067523037813L,
    0.073791808825216637087700538L,
    0.088903842244676376557751794L,
    0.102416382349566725824598924L,
    0.114405347682526793903023851L,
    0.125L,
};
inline constexpr long double kTurnsPerRadian = 0.159154943091895335768883763L;

}  // namespace raycone
