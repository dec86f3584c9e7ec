// Parts of an arrangement that have the same winding number in front everywhere.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/arrangement/arrangement.h"

namespace raycone {

struct ArrangedPatches {
  std::vector<std::uint32_t> of_triangle;  // numbered by their first triangles
  std::vector<std::uint32_t> largest;      // of each patch a triangle
};

// Sets of triangles that are joined by edges of two. None where the boundary is not empty, so that winding numbers are
// no integers.
[[nodiscard]] std::optional<ArrangedPatches> patches_of(const Arrangement& arrangement);

}  // namespace raycone
