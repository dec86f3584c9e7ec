// Doubles in SIMD lanes, kMostLanes at most. Included once per SIMD level.
#if defined(RAYCONE_CORE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYCONE_CORE_LANES_INL_H_
#undef RAYCONE_CORE_LANES_INL_H_
#else
#define RAYCONE_CORE_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <array>
#include <cstdint>

#include "core/machine/simd.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Doubles = hn::CappedTag<double, kMostLanes>;
using Lanes = hn::Vec<Doubles>;
using LaneMask = hn::Mask<Doubles>;
constexpr Doubles d;

// A bit for each lane, the first one lowest.
HWY_INLINE std::uint32_t bits_of(LaneMask lanes) {
  std::array<std::uint8_t, 8> bytes{};  // as many as Highway may write
  hn::StoreMaskBits(d, lanes, bytes.data());
  return bytes[0];
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#endif
