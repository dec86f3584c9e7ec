// Triangles that are summed at many samples, as neighbours that share corners.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/boundary/sample_tile.h"
#include "core/boundary/solid_angle_kernel.h"
#include "core/data/box.h"
#include "core/machine/simd.h"

namespace raycone {

// Whether the triangles of a group look small, looks_small_from(), from all samples that they are ever seen from.
enum class GroupLooks { kAny, kSmall };

// Triangles in chunks, each with the list of its corners: a sample looks at each corner once, which takes most of the
// time of a triangle. The triangles must outlive this.
class SharedCorners {
 public:
  static constexpr std::size_t kInChunk = 32;  // triangles at most

  SharedCorners() = default;
  // Without groups yet: all triangles must be added.
  explicit SharedCorners(std::span<const SolidTriangle> triangles) : triangles_(triangles) {}

  // The next `count` of the triangles. No chunk has triangles of two groups.
  void add_group(std::size_t count, GroupLooks looks);

  struct Places {
    std::uint8_t a, b, c;  // of a triangle's corners among those of its chunk
    std::uint8_t known;    // corners that this triangle and those before it in the chunk have
  };
  struct Chunk {
    std::span<const SolidTriangle> triangles;
    std::span<const Places> places;  // of each
    std::span<const Vec3> corners;   // in the order in which the triangles first need them
    GroupLooks looks;
  };
  [[nodiscard]] std::size_t chunks() const { return chunks_.size(); }
  [[nodiscard]] Chunk chunk(std::size_t n) const;

 private:
  struct Begin {
    std::size_t triangles, corners;
    GroupLooks looks;
  };
  std::span<const SolidTriangle> triangles_;
  std::vector<Places> places_;
  std::vector<Vec3> corners_;
  std::vector<Begin> chunks_;
};

// Whether the triangle is so far from a box, for its size, that nobody needs to look whether its factors can be
// trusted: they can at all points of the box. Its sides then appear under 60 degrees at most, so that two corners have
// a . b >= |a||b| / 2. Hence Re z_T >= 2.5 |a||b||c|, the absolute terms of Im z_T are below 2 |a||b||c|, and Im z_T is
// at most 0.71 |a||b||c|, so that the argument is below 0.28.
[[nodiscard]] bool looks_small_from(const SolidTriangle& triangle, const Box& box);
// The square of the distance beyond which it does, its longest side; infinite where no factor may be trusted.
[[nodiscard]] double square_to_look_small(const SolidTriangle& triangle);

// As SolidAngleKernel, with the bits that it has for samples with a ray each, whatever the shape; but for groups that
// look small, whose factors are multiplied in another order.
using SharedCornersKernel = void (*)(const SharedCorners& triangles, const SampleTile& samples, TileShape shape,
                                     ProductTile& products);

// That of the level, of the best one where the level is not available.
[[nodiscard]] SharedCornersKernel shared_corners_kernel(SimdLevel level, Care care);

}  // namespace raycone
