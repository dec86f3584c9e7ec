// The planes of a patch's faces.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/data/vec3.h"

namespace raycone {

// One side of a plane.
struct PatchPlane {
  Vec3 point, normal;  // of length 1
  bool is_of_source;   // and so the same in any patch

  [[nodiscard]] double distance(const Vec3& p) const { return std::abs(dot(normal, p - point)); }
};

// Numbered as they are added. All faces of a source share its plane, or the same one turned over.
class PatchPlanes {
 public:
  static constexpr std::uint32_t kNoPlane = 0xFFFFFFFF;

  // `input`: what sources are numbers of. It stays where it is while this lives.
  explicit PatchPlanes(const TriangleMesh& input) : input_(input) {}

  [[nodiscard]] const PatchPlane& operator[](std::uint32_t plane) const { return planes_[plane]; }
  [[nodiscard]] std::uint32_t add(const PatchPlane& plane);
  // The source's plane, added when it is first asked for, from the side that a vector in front of it is on.
  [[nodiscard]] std::uint32_t of_source(std::int32_t source, const Vec3& front);

 private:
  static constexpr std::int32_t kNoSource = -2;
  struct SourcePlanes {
    std::int32_t source = kNoSource;
    std::uint32_t own = kNoPlane, turned = kNoPlane;  // with the source's own front, and with its back
  };
  [[nodiscard]] SourcePlanes& planes_of(std::int32_t source);
  void grow();

  const TriangleMesh& input_;
  std::vector<PatchPlane> planes_;
  std::vector<SourcePlanes> source_planes_;  // a hash table: linear probing, at most half full
  std::size_t sources_ = 0;                  // in it
  std::size_t last_source_ = 0;              // the place of the last one that was asked for
};

}  // namespace raycone
