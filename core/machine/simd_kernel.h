// Functions that Highway compiles once per SIMD level. For the part of their file that is compiled once (HWY_ONCE).
#pragma once

#include <hwy/highway.h>

#include <type_traits>

#include "core/machine/simd.h"

namespace raycone {

// The one of the level, of the best one where the level is not available; nullptr stands for levels that the compiler
// does not know.
template <class Function>
[[nodiscard]] Function* at_level(SimdLevel level, std::type_identity_t<Function>* avx512,
                                 std::type_identity_t<Function>* avx2, std::type_identity_t<Function>* sse4,
                                 Function* any_processor) {
  switch (available_level(level)) {
    case SimdLevel::kAvx512:
      return avx512;
    case SimdLevel::kAvx2:
      return avx2;
    case SimdLevel::kSse4:
      return sse4;
    case SimdLevel::kBest:
      break;  // the processor has none of them
  }
  return any_processor;
}

}  // namespace raycone

// at_level() of the function of this name in the namespace of each level.
#define RAYCONE_AT_LEVEL(level, function)                                                                     \
  ::raycone::at_level(level, HWY_CHOOSE_AVX3(function), HWY_CHOOSE_AVX2(function), HWY_CHOOSE_SSE4(function), \
                      &HWY_STATIC_DISPATCH(function))
