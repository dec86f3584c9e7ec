// Faces that cancel.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/mesh/vertex_links.h"

namespace raycone {

// The numbers of faces that cancel in pairs, increasing: those of a pair have the same three vertices and opposite
// orientations. Of more faces on the same vertices, the first of each orientation. Precondition: all triangles are
// noted in `links`. Thread-safe.
[[nodiscard]] std::vector<std::uint32_t> opposite_faces(const TriangleMesh& mesh, const VertexLinks& links);

}  // namespace raycone
