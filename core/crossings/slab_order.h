// Triangles by their place along an axis, so that a slab of a lattice need not look at all of them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/data/interval.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// In groups whose triangles are of about one length along the axis, and neighbours.
class SlabOrder {
 public:
  // Axis 0, 1 or 2. Threaded.
  SlabOrder(const TriangleMesh& mesh, int axis);

  // Numbers of the groups that may hold a triangle whose closed box meets the closed interval.
  [[nodiscard]] std::vector<std::uint32_t> groups_in(double lower, double upper) const;
  // The triangles of a group. Each triangle is in one.
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::uint32_t group) const;

 private:
  std::vector<std::uint32_t> triangles_;  // group by group
  std::vector<Interval> groups_;
};

}  // namespace raycone
