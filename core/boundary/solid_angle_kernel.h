// The inner loop of a sum over triangles: products of factors over many samples at once, in SIMD lanes.
#pragma once

#include <span>

#include "core/boundary/sample_tile.h"
#include "core/data/vec3.h"
#include "core/machine/simd.h"

namespace raycone {

// A triangle of positive area.
struct SolidTriangle {
  Vec3 a, b, c;
  Vec3 normal;         // (b - a) x (c - a), each component rounded once; x is NaN where no factor may be trusted
  double orientation;  // 1, or -1 if it is a, c, b
};

// How far the argument of a factor may be off. Crossings are exact all the same.
enum class Care {
  kFull,   // no more than doubt_of_factors() says (core/boundary/winding_number_engine.h)
  kRough,  // kRoughness times that, so that next to long edges, too, few factors are taken with care
};
inline constexpr double kRoughness = 0x1p10;

// Multiplies the factors z_T of all triangles (core/boundary/solid_angles.h) at all samples; the argument of the
// product is 2 pi times the winding number. One lane is one sample, and its operations come in one order, without fused
// multiply-add: results are the same for every SIMD level. Needs DefaultFloatingPoint. Thread-safe.
using SolidAngleKernel = void (*)(std::span<const SolidTriangle> triangles, const SampleTile& samples,
                                  ProductTile& products);

// That of the level, of the best one where the level is not available.
[[nodiscard]] SolidAngleKernel solid_angle_kernel(SimdLevel level);

}  // namespace raycone
