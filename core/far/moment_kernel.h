// The inner loops of expansions, in SIMD lanes: integrals of solid harmonics along edges, and shifts.
#pragma once

#include <array>
#include <cstddef>

#include "core/far/gauss_rule.h"
#include "core/machine/simd.h"

namespace raycone {

inline constexpr int kMomentOrder = 21;  // of R_n^m, n at most
inline constexpr std::size_t kMomentTerms = std::size_t{(kMomentOrder + 1) * (kMomentOrder + 2) / 2};
inline constexpr std::size_t kMomentLanes = 8;
using MomentLanes = std::array<double, kMomentLanes>;

// Eight edges, by component: where each begins, where it leads, and the vector that its integral is multiplied by.
struct MomentEdges {
  alignas(64) std::array<MomentLanes, 3> from, along, normal;
};

// For each component of these vectors the sums of it times the integral of R_n^m, n < order, in the order of
// multipole_index(n, m, order - 1); lane by lane.
struct MomentSums {
  alignas(64) std::array<std::array<MomentLanes, kMomentTerms>, 3> re, im;
};

// Complex numbers of degrees n up to kMomentOrder + 1 and all m: that of (n, m) is at [n][kMiddle + m].
struct DegreeRows {
  static constexpr int kMiddle = 32;  // whole vectors of zeros around each row
  static constexpr std::size_t kRow = 64;
  alignas(64) std::array<std::array<double, kRow>, kMomentOrder + 2> re{}, im{};
  static_assert(kMiddle > kMomentOrder && kMiddle + kMomentOrder + 1 + kMomentLanes <= kRow);
};

// Operations come in one order, without fused multiply-add: results are the same for every SIMD level. Thread-safe.
struct MomentKernel {
  // Adds eight edges, a lane each.
  void (*add_edges)(const MomentEdges& edges, int order, const GaussRule& rule, MomentSums& sums);
  // Sets sums[n][m], 1 <= n <= order and 0 <= m <= n, to the sum over k < n and |l| <= k of shift[k][l] * part[n - k][m
  // - l]. Of `part`, what is beyond a degree, |m| > n, must be 0; of `sums` it gets no meaning.
  void (*shift)(const DegreeRows& shift, const DegreeRows& part, int order, DegreeRows& sums);
};

// That of the level, of the best one where the level is not available.
[[nodiscard]] MomentKernel moment_kernel(SimdLevel level);

}  // namespace raycone
