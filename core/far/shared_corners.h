// Triangles that are summed at many samples, as neighbours that share corners.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/boundary/sample_tile.h"
#include "core/boundary/solid_angle_kernel.h"
#include "core/machine/simd.h"

namespace raycone {

// Triangles in chunks, each with the list of its corners: a sample looks at each corner once, which takes most of the
// time of a triangle.
class SharedCorners {
 public:
  explicit SharedCorners(std::vector<SolidTriangle> triangles);

  static constexpr std::size_t kInChunk = 32;  // triangles at most
  struct Chunk {
    std::span<const SolidTriangle> triangles;
    std::span<const std::array<std::uint8_t, 3>> places;  // of each one's a, b, c among the corners
    std::span<const Vec3> corners;
  };
  [[nodiscard]] std::size_t chunks() const { return corners_begin_.size() - 1; }
  [[nodiscard]] Chunk chunk(std::size_t n) const;

 private:
  std::vector<SolidTriangle> triangles_;
  std::vector<std::array<std::uint8_t, 3>> places_;
  std::vector<Vec3> corners_;
  std::vector<std::size_t> corners_begin_{0};  // of each chunk; and the end
};

// As SolidAngleKernel, with the bits that it has for samples with a ray each.
using SharedCornersKernel = void (*)(const SharedCorners& triangles, const SampleTile& samples, ProductTile& products);

// That of the level, of the best one where the level is not available.
[[nodiscard]] SharedCornersKernel shared_corners_kernel(SimdLevel level);

}  // namespace raycone
