// Highway would choose the level too, but its library, where it is linked, measures the clock whenever the program
// starts, for as long as all the rest of a small run takes.
#include "core/machine/simd.h"

#include <hwy/detect_targets.h>

#include <initializer_list>

namespace raycone {

bool is_available([[maybe_unused]] SimdLevel level) {
#if HWY_ARCH_X86
  const bool sse4 =
      __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("pclmul") && __builtin_cpu_supports("aes");
  const bool avx2 = sse4 && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                    __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
  const bool avx512 = avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
  if (level == SimdLevel::kSse4) return sse4 && (HWY_TARGETS & HWY_SSE4) != 0;
  if (level == SimdLevel::kAvx2) return avx2 && (HWY_TARGETS & HWY_AVX2) != 0;
  if (level == SimdLevel::kAvx512) return avx512 && (HWY_TARGETS & HWY_AVX3) != 0;
#endif
  return level == SimdLevel::kBest;
}

SimdLevel available_level(SimdLevel wanted) {
  for (const SimdLevel level : {wanted, SimdLevel::kAvx512, SimdLevel::kAvx2, SimdLevel::kSse4}) {
    if (level != SimdLevel::kBest && is_available(level)) return level;
  }
  return SimdLevel::kBest;
}

}  // namespace raycone
