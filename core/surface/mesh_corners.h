// Vertices of a surface that are corners of the mesh, but for rounding and margins.
#pragma once

#include <vector>

#include "core/data/lattice.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// Moves vertices of a surface to vertices of `input` within `reach`: of those near to one of the input's the nearest,
// of equally near ones the first. `lattice`: of about the size of the faces. `reach` is less than its spacing. The used
// vertices of `input` are finite.
void move_to_corners(const TriangleMesh& input, const Lattice& lattice, double reach, std::vector<Vec3>& vertices);

}  // namespace raycone
