// Which faces at an edge belong together.
#pragma once

#include <optional>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/mesh/face_edges.h"

namespace raycone {

// Two faces at an edge with the solid between them. One has the edge forward, the other backward.
struct FacePair {
  FaceEdge forward, backward;
};

// The pairs at all edges of the border of a solid, in the order of the edges. The solid is behind the faces. Nothing
// where the faces do not say on which side it is: at an edge they do not alternate in direction, or one of more than
// two lies on another. Needs DefaultFloatingPoint.
[[nodiscard]] std::optional<std::vector<FacePair>> face_pairs(const TriangleMesh& border);

}  // namespace raycone
