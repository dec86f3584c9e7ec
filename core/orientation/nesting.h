// Which closed surface lies within which.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// Faces without a boundary, which all agree.
struct ClosedSurface {
  std::vector<Triangle> faces;
};

// A surface lies within another one if its box does, if the other's winding number is 0 at none of its points that are
// looked at, and if one of these is not on the other one. Where no face of the other one comes near its box, one vertex
// is looked at: all of it is where that is. Else all vertices are, and both sides of points within the faces. A face
// has from 1 to 256 of these points, by its size, as long as a surface does not get more than 2048, or fewer where
// there are many surfaces; small faces of a surface of more than 4096 faces have none. So a bar across the opening of a
// frame is not within it, although its ends are, and a cavity that touches the walls with all its vertices is. Winding
// numbers are exact. Nothing depends on the order of faces or vertices. Both functions use the threads that ThreadLimit
// allows.

// For each surface the others within which it lies, by number. Takes n^2 time and memory for n boxes within each other.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> surfaces_around(const std::vector<const ClosedSurface*>& surfaces,
                                                                      const std::vector<Vec3>& vertices);

// Of these surfaces, by number, those that lie within no other one, ascending. Of many within each other, the outermost
// one tells at once.
[[nodiscard]] std::vector<std::uint32_t> not_surrounded(std::vector<std::uint32_t> asked,
                                                        const std::vector<const ClosedSurface*>& surfaces,
                                                        const std::vector<Vec3>& vertices);

}  // namespace raycone
