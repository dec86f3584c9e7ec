// How many caps the rays of scattered points cross.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/boundary/sample_tile.h"
#include "core/crossings/projected_grid.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// Thread-safe once made.
class CapCrossings {
 public:
  CapCrossings() = default;  // of no caps
  // `caps` must outlive this.
  explicit CapCrossings(const TriangleMesh& caps) : caps_(&caps) {
    if (!caps.triangles.empty()) grid_.emplace(caps);
  }

  // The sums of the signs of the crossings, exact: one of each sample, 0 beyond. Needs DefaultFloatingPoint.
  [[nodiscard]] std::array<std::int64_t, kTile> of(const SampleTile& samples) const;

 private:
  const TriangleMesh* caps_ = nullptr;
  std::optional<ProjectedGrid> grid_;
};

}  // namespace raycone
