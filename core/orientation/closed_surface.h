// A closed part of a mesh, and points that tell where it lies.
#pragma once

#include <cstddef>
#include <vector>

#include "core/data/box.h"
#include "core/data/triangle_mesh.h"
#include "core/data/vec3.h"

namespace raycone {

// Faces whose directed edges cancel.
struct ClosedSurface {
  std::vector<Triangle> faces;
};

// Half the longest side of a box, in its units. Does not overflow.
[[nodiscard]] double half_longest_side(const Box& box);

// The vertices of a surface, each once.
[[nodiscard]] std::vector<Vec3> vertices_of(const ClosedSurface& surface, const std::vector<Vec3>& vertices);

// At most `most` points within the faces of a surface, up to rounding; `box` is the surface's. Each face has from 1 to
// 256 of them, by its size. Of more than `most` faces, the largest ones have one each. None where the box is a point.
// The same for any order of faces and of their corners.
[[nodiscard]] std::vector<Vec3> points_on_faces(const ClosedSurface& surface, const std::vector<Vec3>& vertices,
                                                const Box& box, std::size_t most);

}  // namespace raycone
