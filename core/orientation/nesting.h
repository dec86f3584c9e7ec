// Which closed patch lies within which.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// Faces without a boundary, which all agree.
struct ClosedSurface {
  std::vector<Triangle> faces;
};

// For each surface the others around it, by number: those whose box holds its box and within which all of its vertices
// lie (winding number not 0). Vertices on the other's surface do not count, as long as one is not. Exact. Takes n^2 time
// and memory for n boxes within each other. Uses the threads that ThreadLimit allows.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> surfaces_around(const std::vector<const ClosedSurface*>& surfaces,
                                                                      const std::vector<Vec3>& vertices);

}  // namespace raycone
