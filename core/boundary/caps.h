// Caps: triangles that close a mesh.
#pragma once

#include <cstddef>
#include <vector>

#include "core/boundary/boundary.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// The exterior edges make up closed loops, since they bound a surface. Caps fill the loops: they have the boundary of
// the mesh, so that the mesh without them (their orientation reversed) is closed. Loops are narrow or wide.
struct Caps {
  TriangleMesh mesh;                     // corners are vertices of the loops; first the caps of narrow loops
  std::size_t narrow = 0;                // caps of narrow loops
  std::vector<DirectedEdge> wide_loops;  // the edges of the others
};

// A loop is narrow if the area of its caps is at most `width` times half of its length, as that of a crack. Linear in
// the sum of multiplicities, times its logarithm.
[[nodiscard]] Caps make_caps(const Boundary& boundary, double width);

// The caps alone, but that two loops that run next to each other, as those of a wall whose rim is missing, are joined
// by a strip, if that has half of the area of their caps or less.
[[nodiscard]] TriangleMesh caps_and_strips(const Boundary& boundary);

}  // namespace raycone
