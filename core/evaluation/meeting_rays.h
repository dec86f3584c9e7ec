// Points of a closed mesh, less those whose rays meet nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/data/vec3.h"
#include "core/evaluation/scaled_mesh.h"

namespace raycone {

// Points of a closed mesh whose rays may meet it, in an order in which neighbours share triangles. Const calls are
// thread-safe.
class MeetingRays {
 public:
  // Of the points [begin, end). The mesh has what points need.
  MeetingRays(const ScaledMesh& mesh, std::span<const Vec3> points, std::size_t begin, std::size_t end);

  [[nodiscard]] std::span<const std::uint32_t> ordered() const { return ordered_; }

  // Those that scaling would change. They are not among the ordered ones.
  [[nodiscard]] std::span<const std::uint32_t> others() const { return others_; }

 private:
  // At most kTile, of which the first one has that index.
  void add(const ScaledMesh& mesh, std::span<const Vec3> points, std::uint32_t first);

  static constexpr std::size_t kBuckets = 256, kCodesPerBucket = ProjectedGrid::kMortonCodes / kBuckets;
  std::size_t count_ = 0;
  std::vector<std::uint8_t> buckets_;
  std::vector<std::uint32_t> indices_, ordered_, others_;
  std::array<std::uint32_t, kBuckets + 1> next_{};
};

}  // namespace raycone
