// The law of Biot and Savart at many samples at once, in SIMD lanes.
#pragma once

#include <span>

#include "core/boundary/sample_tile.h"
#include "core/data/vec3.h"
#include "core/machine/simd.h"

namespace raycone {

// An edge as the law sees it, in a scale in which no coordinate is above 1.
struct GradientSegment {
  Vec3 from, to, step;
  double weight;  // multiplicity over 4 pi
  bool joined;    // begins where the segment before it ends
};

struct GradientTile {
  alignas(64) Tile x;
  alignas(64) Tile y;
  alignas(64) Tile z;
};

// Sets the sums of the segments' parts at the samples, whose coordinates are finite. Where doubles lose a part,
// careful_part() finds it. One lane is one sample, and its operations come in one order, without fused multiply-add:
// results are the same for every SIMD level. Thread-safe.
using GradientKernel = void (*)(std::span<const GradientSegment> segments, const SampleTile& samples,
                                Vec3 (*careful_part)(const GradientSegment& segment, const Vec3& q),
                                GradientTile& sums);

// That of the level, of the best one where the level is not available.
[[nodiscard]] GradientKernel gradient_kernel(SimdLevel level);

}  // namespace raycone
