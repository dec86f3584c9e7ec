#include "core/far/shared_corners.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

// Highway compiles what is between its markers once per SIMD level.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/far/shared_corners.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/far/chunk_lanes-inl.h"
#include "core/machine/simd_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace raycone {
namespace HWY_NAMESPACE {
namespace {

template <class Views>
void multiply_chunk_at_all(ProductTile& products, const SharedCorners::Chunk& chunk, const SampleTile& samples) {
  const auto every = hn::FirstN(d, hn::Lanes(d));
  Views views(chunk, samples);
  const Looks looks = chunk.looks == GroupLooks::kSmall ? Looks::kSmallFromAll : Looks::kLarge;
  for (std::size_t i = 0; i < samples.count; i += hn::Lanes(d)) {
    multiply_chunk(products, chunk, views, samples, i, every, looks);
  }
}

template <Care kCare>
void multiply_chunks(const SharedCorners& triangles, const SampleTile& samples, TileShape shape,
                     ProductTile& products) {
  set_ones(products);
  for (std::size_t n = 0; n < triangles.chunks(); ++n) {
    if (shape == TileShape::kInRows) {
      multiply_chunk_at_all<TrianglesOfRows<kCare>>(products, triangles.chunk(n), samples);
    } else {
      multiply_chunk_at_all<TrianglesOfChunk<kCare>>(products, triangles.chunk(n), samples);
    }
  }
  set_arguments(products, samples.count);
}

void multiply_chunks_here(const SharedCorners& triangles, const SampleTile& samples, TileShape shape,
                          ProductTile& products) {
  multiply_chunks<Care::kFull>(triangles, samples, shape, products);
}

void multiply_chunks_roughly(const SharedCorners& triangles, const SampleTile& samples, TileShape shape,
                             ProductTile& products) {
  multiply_chunks<Care::kRough>(triangles, samples, shape, products);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raycone
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raycone {

SharedCornersKernel shared_corners_kernel(SimdLevel level, Care care) {
  return care == Care::kRough ? RAYCONE_AT_LEVEL(level, multiply_chunks_roughly)
                              : RAYCONE_AT_LEVEL(level, multiply_chunks_here);
}

double square_to_look_small(const SolidTriangle& triangle) {
  constexpr double kLeast = 0x1p-40;  // distance: beyond it no factor is too small to be trusted
  if (std::isnan(triangle.normal.x)) return std::numeric_limits<double>::infinity();
  double square = kLeast * kLeast;
  for (const Vec3& side : {triangle.b - triangle.a, triangle.c - triangle.b, triangle.a - triangle.c}) {
    square = std::max(square, dot(side, side));
  }
  return square * (1 + 0x1p-40);
}

bool looks_small_from(const SolidTriangle& triangle, const Box& box) {
  return square_of_gap(box_of(triangle.a, triangle.b, triangle.c), box) > square_to_look_small(triangle);
}

namespace {

// The corners of a chunk, found by their bits. A corner that has lost its slot to another one comes twice: a table that
// kept both would take longer than looking at that one again.
class CornerSlots {
 public:
  // The place of the corner among those from `first` on; where it is not found, it is added.
  std::uint8_t place_of(const Vec3& corner, std::vector<Vec3>& corners, std::size_t first) {
    std::uint8_t& place = places_[slot_of(corner)];
    if (first + place >= corners.size() || corners[first + place] != corner) {
      place = static_cast<std::uint8_t>(corners.size() - first);
      corners.push_back(corner);
    }
    return place;
  }

 private:
  static constexpr int kBits = 8;

  static std::size_t slot_of(const Vec3& corner) {
    const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
    constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15, kOther = 0xC2B2AE3D27D4EB4F;  // as random as any
    return ((bits(corner.x) * kOdd + bits(corner.y)) * kOther + bits(corner.z) * kOdd) >> (64 - kBits);
  }

  std::array<std::uint8_t, 1 << kBits> places_{};
};

}  // namespace

void SharedCorners::add_group(std::size_t count, GroupLooks looks) {
  const std::size_t begin = places_.size();
  CornerSlots slots;
  for (std::size_t n = begin; n < begin + count; ++n) {
    if ((n - begin) % kInChunk == 0) chunks_.push_back({n, corners_.size(), looks});
    const std::size_t first = chunks_.back().corners;
    const SolidTriangle& t = triangles_[n];
    const std::uint8_t a = slots.place_of(t.a, corners_, first), b = slots.place_of(t.b, corners_, first),
                       c = slots.place_of(t.c, corners_, first);
    places_.push_back({a, b, c, static_cast<std::uint8_t>(corners_.size() - first)});
  }
}

SharedCorners::Chunk SharedCorners::chunk(std::size_t n) const {
  const Begin begin = chunks_[n];
  const Begin end = n + 1 < chunks_.size() ? chunks_[n + 1] : Begin{places_.size(), corners_.size(), GroupLooks::kAny};
  const std::size_t count = end.triangles - begin.triangles;
  return {triangles_.subspan(begin.triangles, count), std::span(places_).subspan(begin.triangles, count),
          std::span(corners_).subspan(begin.corners, end.corners - begin.corners), begin.looks};
}

}  // namespace raycone
#endif
