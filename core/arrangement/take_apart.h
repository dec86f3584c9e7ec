// Solids that touch along edges or at vertices, taken apart there.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// Makes a 2-manifold of the border of a solid: where it touches itself in a vertex or along an edge, each part of the
// solid gets a vertex of its own, which all of them but one have moved into their insides by `distance`. Faces along an
// edge belong together where the solid is between them. An edge along which that leaves two parts the same two ends is
// halved. `sources`: of each triangle, and so of its halves. New vertices are rounded to float with
// `single_precision`. False, and the border is left half done, where it has no two sides, or two parts have no vertex
// in their insides. Whether what is moved meets nothing must be looked at after it. Preconditions: every edge has as
// many faces in either direction, which meet in nothing but common corners and edges. Needs DefaultFloatingPoint.
[[nodiscard]] bool take_apart(TriangleMesh& border, std::vector<std::uint32_t>& sources, double distance,
                              bool single_precision);

}  // namespace raycone
