// What sorting triangles into a search tree's order spends its time with, in SIMD lanes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/machine/simd.h"

namespace raycone {

// Triangles by where they are along each axis, and their numbers. Columns, so that lanes take many at once.
struct PlacedTriangles {
  std::array<std::uint32_t*, 3> place;
  std::uint32_t* number;

  // Orders by the place along an axis, then by number.
  [[nodiscard]] std::uint64_t key(std::size_t axis, std::size_t n) const {
    return std::uint64_t{place[axis][n]} << 32 | number[n];
  }
  [[nodiscard]] PlacedTriangles from(std::size_t n) const {
    return {{place[0] + n, place[1] + n, place[2] + n}, number + n};
  }
};

constexpr std::size_t kMostSorted = 64;  // by counting

// Both change `count` triangles, no others.
struct SelectionKernel {
  // Puts those whose keys are below `pivot` first; returns their number. `room` is for `count` others.
  std::size_t (*partition)(const PlacedTriangles& triangles, const PlacedTriangles& room, std::size_t count,
                           std::size_t axis, std::uint64_t pivot);
  // Sorts at most kMostSorted by their keys, no two of which are the same.
  void (*sort_few)(const PlacedTriangles& triangles, std::size_t count, std::size_t axis);
};

// Those of the level, of the best one where the level is not available. The order is the same for every level.
[[nodiscard]] SelectionKernel selection_kernel(SimdLevel level);

}  // namespace raycone
