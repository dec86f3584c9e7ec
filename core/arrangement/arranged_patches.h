// Parts of an arrangement that have the same winding number in front everywhere.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/arrangement/arrangement.h"

namespace raycone {

struct ArrangedPatches {
  std::vector<std::uint32_t> of_triangle;  // per triangle its patch; patches count from 0 by their first triangles
  std::vector<std::uint32_t> largest;      // per patch its largest triangle, as far as doubles tell
};

// Joins triangles across edges of exactly two. None where the mesh is open: its winding numbers are no integers.
[[nodiscard]] std::optional<ArrangedPatches> patches_of(const Arrangement& arrangement);

}  // namespace raycone
