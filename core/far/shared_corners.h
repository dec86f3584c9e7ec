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
// time of a triangle. The triangles must outlive this.
class SharedCorners {
 public:
  static constexpr std::size_t kInChunk = 32;  // triangles at most

  SharedCorners() = default;
  // One group of all.
  explicit SharedCorners(std::span<const SolidTriangle> triangles);
  // No group yet: all triangles must be added.
  static SharedCorners without_groups(std::span<const SolidTriangle> triangles) {
    SharedCorners none;
    none.triangles_ = triangles;
    return none;
  }

  // The next `count` of the triangles. No chunk has triangles of two groups.
  void add_group(std::size_t count);

  struct Chunk {
    std::span<const SolidTriangle> triangles;
    std::span<const std::array<std::uint8_t, 3>> places;  // of each one's a, b, c among the corners
    std::span<const Vec3> corners;
  };
  [[nodiscard]] std::size_t chunks() const { return chunks_.size(); }
  [[nodiscard]] Chunk chunk(std::size_t n) const;

 private:
  struct Begin {
    std::size_t triangles, corners;
  };
  std::span<const SolidTriangle> triangles_;
  std::vector<std::array<std::uint8_t, 3>> places_;
  std::vector<Vec3> corners_;
  std::vector<Begin> chunks_;
};

// As SolidAngleKernel, with the bits that it has for samples with a ray each.
using SharedCornersKernel = void (*)(const SharedCorners& triangles, const SampleTile& samples, ProductTile& products);

// That of the level, of the best one where the level is not available.
[[nodiscard]] SharedCornersKernel shared_corners_kernel(SimdLevel level);

}  // namespace raycone
