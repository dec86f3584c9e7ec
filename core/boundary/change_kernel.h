// The inner loop of bounds of change: what sources in boxes add to derivatives, eight at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/data/box.h"
#include "core/machine/simd.h"

namespace raycone {

// Eight sources, or clusters of sources, each in a box. Of a source `length` is L / (4 pi) of a piece of an edge,
// `area` 2 A / (4 pi) of a cap; of a cluster they are sums. Where there is none, the box is infinitely far away.
struct alignas(64) ChangeNode {
  using Numbers = std::array<double, 8>;
  std::array<Numbers, 3> lower, upper;
  Numbers far_square;  // from beyond the square of this distance on it is taken as one; less than 0 for a source
  Numbers length, area;
  std::array<std::uint32_t, 8> child;  // the node of a cluster
};

inline constexpr std::size_t kChangeOrders = 8;

// [k - 1]: of derivatives of order k, divided by k!.
using ChangeSums = std::array<double, kChangeOrders>;

// Bounds of what all sources below node 0 add in a box, but for rounding. Sums come in one order: they are the same for
// every SIMD level. Infinite where a source is closer than 2^-330. Thread-safe.
struct ChangeKernel {
  // To gradients; infinite beyond `limit`.
  double (*gradient)(std::span<const ChangeNode> nodes, const Box& box, double limit);
  ChangeSums (*derivatives)(std::span<const ChangeNode> nodes, const Box& box);
};

// That of the level, of the best one where the level is not available.
[[nodiscard]] ChangeKernel change_kernel(SimdLevel level);

}  // namespace raycone
