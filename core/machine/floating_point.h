// The floating-point environment that exact predicates rely on.
#pragma once

#include <xmmintrin.h>

namespace raycone {

// Sets MXCSR to its default (round to nearest, exceptions masked, no flush-to-zero, no denormals-are-zero) and restores
// what was there. Embree turns both flushes on in threads that it touches; signs of predicates would then be wrong for
// coordinates below 1e-97 (docs/method.md, "Floating-point environment").
class DefaultFloatingPoint {
 public:
  DefaultFloatingPoint() : saved_(_mm_getcsr()) { _mm_setcsr(kDefault); }
  ~DefaultFloatingPoint() { _mm_setcsr(saved_); }
  DefaultFloatingPoint(const DefaultFloatingPoint&) = delete;
  DefaultFloatingPoint& operator=(const DefaultFloatingPoint&) = delete;

  // Rounding, flush-to-zero and denormals-are-zero are as above; exception flags do not matter.
  [[nodiscard]] static bool holds() { return (_mm_getcsr() & 0xFFC0U) == (kDefault & 0xFFC0U); }

 private:
  static constexpr unsigned kDefault = 0x1F80;
  unsigned saved_;
};

}  // namespace raycone
