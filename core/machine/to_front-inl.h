// Some lanes of a vector, moved together. Included once per SIMD level.
#if defined(RAYCONE_CORE_TO_FRONT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYCONE_CORE_TO_FRONT_INL_H_
#undef RAYCONE_CORE_TO_FRONT_INL_H_
#else
#define RAYCONE_CORE_TO_FRONT_INL_H_
#endif

#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kTableLanes = 8;

// For each set of lanes, a bit each: the numbers of those that are in it, then some others.
constexpr auto kFront = [] {
  std::array<std::array<std::uint8_t, kTableLanes>, std::size_t{1} << kTableLanes> front{};
  for (std::size_t set = 0; set < front.size(); ++set) {
    std::size_t next = 0;
    for (std::size_t lane = 0; lane < kTableLanes; ++lane) {
      if ((set >> lane & 1) != 0) front[set][next++] = static_cast<std::uint8_t>(lane);
    }
  }
  return front;
}();

// Of vectors of at most kTableLanes lanes, of 4 or 8 bytes each. Not by Highway's Compress(), which copies a table of
// up to a kilobyte before each use (1.0.3).
template <class Tag>
class ToFrontByTable {
 public:
  explicit HWY_INLINE ToFrontByTable(hn::Mask<Tag> set) : indices_(indices_of(set)) {}

  template <class Other>
  HWY_INLINE hn::Vec<Other> operator()(Other other, hn::Vec<Other> lanes) const {
    return hn::BitCast(other, hn::TableLookupLanes(hn::BitCast(Tag(), lanes), indices_));
  }

 private:
  using Signed = hn::RebindToSigned<Tag>;
  using Indices = decltype(hn::IndicesFromVec(Tag(), hn::Vec<Signed>()));

  static HWY_INLINE Indices indices_of(hn::Mask<Tag> set) {
    std::array<std::uint8_t, 8> bits{};  // as many as Highway may write
    hn::StoreMaskBits(Tag(), set, bits.data());
    const auto& front = kFront[bits[0]];
    const Signed integers;
    if constexpr (sizeof(hn::TFromD<Tag>) == 4) {
      const hn::Rebind<std::uint8_t, Tag> bytes;
      return hn::IndicesFromVec(Tag(), hn::PromoteTo(integers, hn::LoadU(bytes, front.data())));
    } else {
      const hn::RebindToUnsigned<Tag> unsigned_integers;
      const auto all = hn::Set(unsigned_integers, std::bit_cast<std::uint64_t>(front));  // the first in the lowest byte
      const auto bytes = hn::Shr(all, hn::ShiftLeft<3>(hn::Iota(unsigned_integers, 0)));
      const auto numbers = hn::And(bytes, hn::Set(unsigned_integers, kTableLanes - 1));
      return hn::IndicesFromVec(Tag(), hn::BitCast(integers, numbers));
    }
  }

  Indices indices_;
};

// Of vectors of more lanes, which have an instruction for it. Not into memory, as by Highway's CompressStore(): Zen 4
// takes more than a hundred cycles for that.
template <class Tag>
class ToFrontAtOnce {
 public:
  explicit HWY_INLINE ToFrontAtOnce(hn::Mask<Tag> set) : set_(set) {}

  template <class Other>
  HWY_INLINE hn::Vec<Other> operator()(Other other, hn::Vec<Other> lanes) const {
    return hn::BitCast(other, hn::Compress(hn::BitCast(Tag(), lanes), set_));
  }

 private:
  hn::Mask<Tag> set_;
};

// Moves the lanes of a set to the front, in their order, in vectors of lanes of that size: front(tag, lanes). What is
// behind them may be anything.
template <class Tag>
using ToFront = std::conditional_t<(hn::MaxLanes(Tag()) <= kTableLanes), ToFrontByTable<Tag>, ToFrontAtOnce<Tag>>;

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#endif
