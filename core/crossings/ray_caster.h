// Candidate triangles of rays along +x, found by Embree.
#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// Embree is not installed, or cannot be loaded.
class EmbreeUnavailable : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Embree traverses boxes in float, nothing else: whether a candidate is crossed is decided by
// core/crossings/crossings.h on the double coordinates. Taking Embree's own hits would be wrong by 1 at some rays,
// arbitrarily far from the surface.
class RayCaster {
 public:
  // Builds the acceleration structure. `mesh` must outlive the RayCaster and have at least one triangle. Throws
  // std::bad_alloc, EmbreeUnavailable, or std::runtime_error with the number of Embree's error.
  explicit RayCaster(const TriangleMesh& mesh);
  ~RayCaster();
  RayCaster(RayCaster&&) noexcept;

  // Replaces `candidates` by triangle indices in unspecified order: each triangle whose closed box meets the closed ray
  // {origin + t x, t >= 0} once, and possibly others. Thread-safe.
  void find_candidates(const Vec3& origin, std::vector<std::uint32_t>& candidates) const;

 private:
  struct Scene;
  std::unique_ptr<const Scene> scene_;
};

}  // namespace raycone
