// A surface, triangle by triangle of the mesh that it follows.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

inline constexpr std::int32_t kHole = -1;  // in place of a triangle

struct SurfaceMesh {
  TriangleMesh mesh;
  std::vector<std::int32_t> sources;  // of each triangle: a triangle of the input, or kHole
};

[[nodiscard]] bool has_holes(const SurfaceMesh& surface);

// A face that is not there has three equal corners.
[[nodiscard]] inline bool is_gone(const Triangle& t) { return t[0] == t[1]; }

// Drops the faces that are gone, and the vertices that no face has then.
void drop_gone(SurfaceMesh& surface);

}  // namespace raycone
