// Eight boxes, which one box is compared with at a time.
#pragma once

#include <emmintrin.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>

#include "core/data/box.h"

namespace raycone {

// A box as SIMD lanes take it. By halves, whose differences do not overflow.
struct HalfBox {
  __m128d lower, upper;  // x and y
  __m128d z;             // the lower one and the upper one

  explicit HalfBox(const Box& box)
      : lower(half(box.lower.x, box.lower.y)),
        upper(half(box.upper.x, box.upper.y)),
        z(half(box.lower.z, box.upper.z)) {}

 private:
  static __m128d half(double first, double second) { return _mm_mul_pd(_mm_set_pd(second, first), _mm_set1_pd(0.5)); }
};

// Up to eight boxes, in units of the box of them all: two boxes are told apart wherever they are in a mesh, and however
// large that is. Units of the whole mesh would make all boxes meet where a stray triangle is far away.
class alignas(64) BoxNode {
 public:
  static constexpr std::size_t kWidth = 8;

  BoxNode() = default;
  // `all`: the box of the children. Those that are missing are empty boxes, which meet nothing.
  BoxNode(std::span<const Box> children, const Box& all) : half_lower_(0.5 * all.lower) {
    const double half_size = longest_side(half_of(all));
    units_ = half_size > 0.0 ? std::min(kUnits / half_size, std::numeric_limits<double>::max()) : 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lower_[axis].fill(std::numeric_limits<std::int16_t>::max());
      upper_[axis].fill(std::numeric_limits<std::int16_t>::min());
    }
    for (std::size_t child = 0; child < children.size(); ++child) {
      std::array<std::int16_t, kWidth> sides;  // as in_units() has them
      const __m128i in_lanes = in_units(HalfBox(children[child]));
      std::memcpy(sides.data(), &in_lanes, sizeof sides);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        lower_[axis][child] = sides[kLower[axis]];
        upper_[axis][child] = sides[kUpper[axis]];
      }
    }
  }

  // A bit for each child whose closed box meets `box`, and for those of which that is not sure in these units.
  [[nodiscard]] unsigned meeting(const HalfBox& box) const {
    const __m128i sides = in_units(box);
    const __m128i apart =
        _mm_or_si128(_mm_or_si128(apart_along<0>(sides), apart_along<1>(sides)), apart_along<2>(sides));
    return ~static_cast<unsigned>(_mm_movemask_epi8(_mm_packs_epi16(apart, apart))) & 0xFFU;
  }

 private:
  static constexpr double kUnits = 0x7FFE;  // of the longest side; what is beyond a box has one more or less
  static constexpr std::array<std::size_t, 3> kLower{0, 1, 4}, kUpper{2, 3, 5};  // lanes of in_units() by axis

  // Each step is monotone, so that boxes that meet have numbers that do.
  [[nodiscard]] __m128i in_units(const HalfBox& box) const {
    const __m128d from = _mm_loadu_pd(&half_lower_.x);
    const __m128i x_and_y = _mm_unpacklo_epi64(in_units(box.lower, from), in_units(box.upper, from));
    return _mm_packs_epi32(x_and_y, in_units(box.z, _mm_set1_pd(half_lower_.z)));
  }
  [[nodiscard]] __m128i in_units(__m128d half, __m128d from) const {
    const __m128d units = _mm_mul_pd(_mm_sub_pd(half, from), _mm_set1_pd(units_));
    return _mm_cvttpd_epi32(_mm_min_pd(_mm_max_pd(units, _mm_set1_pd(-1.0)), _mm_set1_pd(kUnits + 1)));
  }
  template <std::size_t kAxis>
  [[nodiscard]] __m128i apart_along(__m128i sides) const {
    return _mm_or_si128(_mm_cmpgt_epi16(load(lower_[kAxis]), in_all_lanes<kUpper[kAxis]>(sides)),
                        _mm_cmpgt_epi16(in_all_lanes<kLower[kAxis]>(sides), load(upper_[kAxis])));
  }
  static __m128i load(const std::array<std::int16_t, kWidth>& lanes) {
    return _mm_load_si128(reinterpret_cast<const __m128i*>(lanes.data()));
  }
  template <std::size_t kLane>
  static __m128i in_all_lanes(__m128i lanes) {
    constexpr int kOfHalf = static_cast<int>(kLane % 4) * 0x55;  // the lane in four places
    if constexpr (kLane < 4) return _mm_shuffle_epi32(_mm_shufflelo_epi16(lanes, kOfHalf), 0);
    return _mm_shuffle_epi32(_mm_shufflehi_epi16(lanes, kOfHalf), 0xAA);
  }

  std::array<std::array<std::int16_t, kWidth>, 3> lower_, upper_;  // by axis
  Vec3 half_lower_;
  double units_ = 0.0;  // per half of a length
};

}  // namespace raycone
