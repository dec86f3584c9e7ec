// The argument of a complex number.
#pragma once

namespace raycone {

// The argument of re + i im in turns (units of 2 pi), in [-1/2, 1/2], with the sign bit of im. Not both 0. The relative
// error is below kArgumentError times u, half a unit in the last place of Real's 1. Our own, because the C library's
// atan2 rounds differently on CPUs with and without fused multiply-add.
inline constexpr int kArgumentError = 7;
template <class Real>  // double or long double
[[nodiscard]] Real argument_in_turns(Real re, Real im);

}  // namespace raycone
