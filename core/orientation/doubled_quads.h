// Quadrilaterals that are there twice, cut into triangles along different diagonals.
#pragma once

#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/data/vec3.h"
#include "core/orientation/face_neighbours.h"
#include "core/orientation/unique_faces.h"

namespace raycone {

// Where a mesh is double-sided, cuts one copy of such a quadrilateral along the diagonal of the other copy: that with
// an end at the lowest corner by coordinates. So their triangles become copies, too, whichever way round they are
// stored.
// A mesh counts as double-sided if all but a sixteenth of its faces would then be copies. Where fewer would be, the
// quadrilaterals may be walls between cells, each of which is right as it is. Four triangles of four vertices may also
// be a tetrahedron: so both copies must be flat, to 2^-20 of their longest side or 2^-22 of the largest coordinate, and
// there must be other faces at an edge.
// `unique` and `neighbours` are those of the triangles; the vertices are in unit_scale(). Returns whether anything was
// cut. Takes time in proportion to the faces at edges of three and more.
[[nodiscard]] bool match_diagonals(std::vector<Triangle>& triangles, const std::vector<Vec3>& vertices,
                                   const UniqueFaces& unique, const FaceNeighbours& neighbours);

}  // namespace raycone
