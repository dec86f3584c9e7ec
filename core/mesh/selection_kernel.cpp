#include "core/mesh/selection_kernel.h"

#include <algorithm>
#include <array>
#include <limits>

// Highway compiles what is between its markers once per SIMD level.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/mesh/selection_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/machine/simd_kernel.h"
#include "core/machine/to_front-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Columns = std::array<std::uint32_t*, 4>;

Columns columns_of(const PlacedTriangles& triangles) {
  return {triangles.place[0], triangles.place[1], triangles.place[2], triangles.number};
}

using Numbers = hn::ScalableTag<std::uint32_t>;

// Without branches, which nobody could predict. Whole vectors are stored where their triangles, or those before them,
// were read: what is behind the last triangle stays as it is.
std::size_t partition(const PlacedTriangles& triangles, const PlacedTriangles& room, std::size_t count,
                      std::size_t axis, std::uint64_t pivot) {
  const Numbers d;
  const Columns columns = columns_of(triangles), apart = columns_of(room);
  const auto place = hn::Set(d, static_cast<std::uint32_t>(pivot >> 32));
  const auto number = hn::Set(d, static_cast<std::uint32_t>(pivot));
  std::size_t below = 0, others = 0, n = 0;
  for (; n + hn::Lanes(d) <= count; n += hn::Lanes(d)) {
    const auto places = hn::LoadU(d, columns[axis] + n);
    const auto ties = hn::And(hn::Eq(places, place), hn::Lt(hn::LoadU(d, triangles.number + n), number));
    const auto is_below = hn::Or(hn::Lt(places, place), ties);
    const ToFront<Numbers> below_first(is_below), others_first(hn::Not(is_below));
    for (std::size_t c = 0; c < 4; ++c) {
      const auto column = hn::LoadU(d, columns[c] + n);
      hn::StoreU(below_first(d, column), d, columns[c] + below);
      hn::StoreU(others_first(d, column), d, apart[c] + others);
    }
    const std::size_t found = hn::CountTrue(d, is_below);
    below += found;
    others += hn::Lanes(d) - found;
  }
  for (; n < count; ++n) {
    const std::size_t is_below = triangles.key(axis, n) < pivot ? 1 : 0;
    for (std::size_t c = 0; c < 4; ++c) columns[c][below] = apart[c][others] = columns[c][n];
    below += is_below;
    others += 1 - is_below;
  }
  for (std::size_t c = 0; c < 4; ++c) std::copy_n(apart[c], others, columns[c] + below);
  return below;
}

// Each goes where as many keys as are below its own say.
void sort_few(const PlacedTriangles& triangles, std::size_t count, std::size_t axis) {
  const hn::ScalableTag<std::int64_t> d;
  alignas(64) std::array<std::int64_t, kMostSorted> keys;
  std::array<std::array<std::uint32_t, kMostSorted>, 4> before;
  const Columns columns = columns_of(triangles);
  for (std::size_t c = 0; c < 4; ++c) std::copy_n(columns[c], count, before[c].begin());
  keys.fill(std::numeric_limits<std::int64_t>::max());
  for (std::size_t n = 0; n < count; ++n) keys[n] = static_cast<std::int64_t>(triangles.key(axis, n));
  for (std::size_t n = 0; n < count; ++n) {
    const auto key = hn::Set(d, keys[n]);
    std::size_t below = 0;
    for (std::size_t other = 0; other < count; other += hn::Lanes(d)) {
      below += hn::CountTrue(d, hn::Lt(hn::Load(d, &keys[other]), key));
    }
    for (std::size_t c = 0; c < 4; ++c) columns[c][below] = before[c][n];
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raycone {

SelectionKernel selection_kernel(SimdLevel level) {
  return {RAYCONE_AT_LEVEL(level, partition), RAYCONE_AT_LEVEL(level, sort_few)};
}

}  // namespace raycone
#endif
