// Where the faults of a surface are, for those who undo what has made them.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/cells/node_set.h"
#include "core/certificate/certificate.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// Of each vertex, whether it is a corner of a face that intersects another. `count`: of all vertices; `triangles`: of
// the mesh that the faults are of.
[[nodiscard]] std::vector<bool> faulty_vertices(std::size_t count, const std::vector<Triangle>& triangles,
                                                const SurfaceFaults& faults);

// The corners of the cell that a point is in. A point between cells, as vertices of a contour are, is in the cell of
// larger coordinates, as far as rounding can tell. Points beyond the lattice are in its outermost cells.
[[nodiscard]] std::array<NodeSet::Node, 8> corners_of_cell_at(const Vec3& p, const Lattice& lattice);

// Whether one of corners_of_cell_at(p) is in `nodes`.
[[nodiscard]] bool is_beside(const Vec3& p, const NodeSet& nodes);

// Of each triangle, whether its box, widened by a voxel on each side, has one of `nodes` in it.
[[nodiscard]] std::vector<bool> faces_beside(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles,
                                             const NodeSet& nodes);

// Sets `touched` to true for the corners of triangles for which faces_beside() holds.
void touch_faces_beside(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles, const NodeSet& nodes,
                        std::vector<bool>& touched);

}  // namespace raycone
