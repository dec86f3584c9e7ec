// Where the faults of a surface are, for those who undo what has made them.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/cells/node_set.h"
#include "core/certificate/certificate.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// The vertices of faces that intersect. `count`: of all vertices; `triangles`: of the mesh that the faults are of.
[[nodiscard]] std::vector<bool> faulty_vertices(std::size_t count, const std::vector<Triangle>& triangles,
                                                const SurfaceFaults& faults);

// The corners of the cell that a point is in. A point between cells, as vertices of a contour are, is in the one of
// larger coordinates, as far as rounding can tell. Points beyond the lattice are in its outermost cells.
[[nodiscard]] std::array<NodeSet::Node, 8> corners_of_cell_at(const Vec3& p, const Lattice& lattice);

// Whether one of these is one of `nodes`.
[[nodiscard]] bool is_beside(const Vec3& p, const NodeSet& nodes);

// Of each triangle whether its box, a voxel larger on each side, has one of `nodes`.
[[nodiscard]] std::vector<bool> faces_beside(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles,
                                             const NodeSet& nodes);

// Adds the vertices of these triangles to those that are `touched`.
void touch_faces_beside(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles, const NodeSet& nodes,
                        std::vector<bool>& touched);

}  // namespace raycone
