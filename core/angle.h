// Sums of arguments of complex numbers as the argument of their product.
#pragma once

namespace raycone {

// The argument of re + i im in turns (units of 2 pi), in [-1/2, 1/2], with the sign bit of im; within 3e-16. Not both
// 0. Our own, because the C library's atan2 rounds differently on CPUs with and without fused multiply-add.
[[nodiscard]] double argument_in_turns(double re, double im);

}  // namespace raycone
