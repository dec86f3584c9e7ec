// Points in an order in which neighbours are near to each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/data/vec3.h"
#include "core/evaluation/scaled_mesh.h"
#include "core/machine/buckets.h"

namespace raycone {

// A radix sort by position along a curve, through the projections or through space, that moves the points themselves,
// so that none has to be fetched from afar in the end. On all threads; const calls are thread-safe.
class CoherentOrder {
 public:
  struct SortedPoint {
    Vec3 point;
    std::uint32_t index;  // among the points
    std::uint32_t key;
  };
  static constexpr std::size_t kBuckets = 256;

  // Less than 2^32 points.
  CoherentOrder(const ScaledMesh& mesh, std::span<const Vec3> points) : CoherentOrder(points, keys_of(mesh, points)) {}

  // How many points are put in order together: enough that neighbours are near, few enough that they take little
  // memory. Around a far field that pays more: the nearer neighbours are, the more nodes they share.
  static std::size_t batch(const ScaledMesh& mesh) {
    return std::size_t{1} << (mesh.blocks_of_points() || mesh.has_far_field() ? 19 : 17);
  }

  // Of points outside of the blocks of points, where the mesh has them; in the others the key is that of the group + 1.
  static constexpr std::uint32_t kOutside = 0;

  // Whether the mesh can take all of the points.
  [[nodiscard]] bool all_taken() const { return all_taken_; }
  // Of points in blocks of points.
  [[nodiscard]] std::span<const std::uint32_t> groups() const { return groups_; }

  // Those of one bucket, in order.
  [[nodiscard]] std::vector<SortedPoint> operator[](std::size_t bucket) const;

 private:
  struct Keys {
    std::uint32_t count;  // of those there can be
    std::vector<std::uint32_t> of_points;
    bool all_taken = true;
    std::vector<std::uint32_t> groups;
  };

  CoherentOrder(std::span<const Vec3> points, const Keys& keys);
  static Keys keys_of(const ScaledMesh& mesh, std::span<const Vec3> points);
  static Keys keys_in_blocks(const ScaledMesh& mesh, const PointBlocks& blocks, std::span<const Vec3> points);
  static Keys keys_along_curves(const ScaledMesh& mesh, std::span<const Vec3> points);

  bool all_taken_;
  std::vector<std::uint32_t> groups_;
  std::size_t keys_per_bucket_;
  Buckets<SortedPoint> buckets_;
};

}  // namespace raycone
