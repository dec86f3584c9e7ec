// Faces that cancel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// The numbers of faces that cancel in pairs, increasing: those of a pair have the same three vertices and opposite
// orientations. Of more faces on the same vertices, the first of each orientation. Thread-safe.
[[nodiscard]] std::vector<std::uint32_t> opposite_faces(const TriangleMesh& mesh);

}  // namespace raycone
