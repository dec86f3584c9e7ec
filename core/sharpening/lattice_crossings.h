// Where faces of a surface cross the edges of a lattice.
#pragma once

#include <vector>

#include "core/data/lattice.h"
#include "core/data/triangle_mesh.h"
#include "core/distance/distance.h"

namespace raycone {

// The points, up to rounding, where a triangle crosses edges of the lattice, along any axis, farther than `off` (world
// units) from the mesh that `distance` is from. An edge that runs along a triangle does not cross it. `lattice`: with
// the triangle within, or not far from it. Thread-safe.
[[nodiscard]] std::vector<Vec3> crossings_off_mesh(const Corners3& triangle, const Lattice& lattice,
                                                   const DistanceEvaluator& distance, double off);

}  // namespace raycone
