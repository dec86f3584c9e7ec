// Some lanes of a vector, moved together. Included once per SIMD level.
#if defined(RAYCONE_CORE_TO_FRONT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYCONE_CORE_TO_FRONT_INL_H_
#undef RAYCONE_CORE_TO_FRONT_INL_H_
#else
#define RAYCONE_CORE_TO_FRONT_INL_H_
#endif

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/distance/triangle_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

using Places = hn::RebindToSigned<Doubles>;
using Unsigned = hn::RebindToUnsigned<Doubles>;

// For each set of lanes, a bit each: the numbers of those that are in it, a byte each, from the lowest byte on.
constexpr std::array<std::uint64_t, std::size_t{1} << kWidth> kFront = [] {
  std::array<std::uint64_t, std::size_t{1} << kWidth> front{};
  for (std::size_t set = 0; set < front.size(); ++set) {
    std::size_t shift = 0;
    for (std::size_t lane = 0; lane < kWidth; ++lane) {
      if ((set >> lane & 1) == 0) continue;
      front[set] |= static_cast<std::uint64_t>(lane) << shift;
      shift += 8;
    }
  }
  return front;
}();

// Moves the wanted lanes to the front, in their order. Not Highway's CompressStore(): as one instruction into memory,
// Zen 4 takes more than a hundred cycles for it; and not its Compress(), which copies a table before each use (1.0.3).
class ToFront {
 public:
  explicit HWY_INLINE ToFront(LaneMask wanted) : indices_(indices_of(wanted)), count_(hn::CountTrue(d, wanted)) {}
  HWY_INLINE std::size_t count() const { return count_; }
  // Writes a whole vector.
  template <class Tag>
  HWY_INLINE void store(Tag tag, hn::Vec<Tag> lanes, hn::TFromD<Tag>* to) const {
    hn::StoreU(hn::BitCast(tag, hn::TableLookupLanes(hn::BitCast(d, lanes), indices_)), tag, to);
  }

 private:
  using Indices = decltype(hn::IndicesFromVec(d, hn::Vec<Places>()));
  static HWY_INLINE Indices indices_of(LaneMask wanted) {
    std::array<std::uint8_t, 8> bits{};  // as many as Highway may write
    hn::StoreMaskBits(d, wanted, bits.data());
    const Unsigned integers;
    const auto bytes = hn::Shr(hn::Set(integers, kFront[bits[0]]), hn::ShiftLeft<3>(hn::Iota(integers, 0)));
    return hn::IndicesFromVec(d, hn::BitCast(Places(), hn::And(bytes, hn::Set(integers, kWidth - 1))));
  }

  Indices indices_;
  std::size_t count_;
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#endif
