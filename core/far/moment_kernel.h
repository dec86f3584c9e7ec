// The inner loop of expansions: integrals of solid harmonics along edges, in SIMD lanes.
#pragma once

#include <array>
#include <cstddef>

#include "core/machine/simd.h"

namespace raycone {

inline constexpr int kMomentOrder = 15;  // of R_n^m, n at most
inline constexpr std::size_t kMomentTerms = std::size_t{(kMomentOrder + 1) * (kMomentOrder + 2) / 2};
inline constexpr std::size_t kMomentLanes = 8;
using MomentLanes = std::array<double, kMomentLanes>;

// Eight edges, by component: where each begins, where it leads, and the vector that its integral is multiplied by.
struct MomentEdges {
  alignas(64) std::array<MomentLanes, 3> from, along, normal;
};

// For each component of these vectors the sums of it times the integral of R_n^m, in the order of multipole_index(n, m,
// kMomentOrder); lane by lane.
struct MomentSums {
  alignas(64) std::array<std::array<MomentLanes, kMomentTerms>, 3> re{}, im{};
};

// Adds eight edges. One lane is one edge, and its operations come in one order, without fused multiply-add: results are
// the same for every SIMD level. Integrals are by Gauss's rule of eight points, exact but for rounding. Thread-safe.
using MomentKernel = void (*)(const MomentEdges& edges, MomentSums& sums);

// That of the level, of the best one where the level is not available.
[[nodiscard]] MomentKernel moment_kernel(SimdLevel level);

}  // namespace raycone
