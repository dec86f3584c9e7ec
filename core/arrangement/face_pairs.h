// Which faces at an edge belong together.
#pragma once

#include <optional>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/mesh/face_edges.h"

namespace raycone {

// Two faces at an edge between which the solid is.
struct FacePair {
  FaceEdge forward, backward;
};

// The pairs at all edges of the border of a solid, which is behind its faces; in the order of the edges. Nothing where
// the border has no two sides: faces of either direction do not alternate around an edge, or of more than two one lies
// on another. Needs DefaultFloatingPoint.
[[nodiscard]] std::optional<std::vector<FacePair>> face_pairs(const TriangleMesh& border);

}  // namespace raycone
