// Sharp edges where a lattice does not see them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/surface/contour.h"

namespace raycone {

struct SharpenLimits {
  double off = 0.0;    // a face is in the plane of its source if its corners are not farther from it, world units
  double reach = 0.0;  // how far a vertex is pulled at most, likewise
  bool single_precision = false;  // vertices are rounded to float
  bool strips_may_turn = true;    // what is left of them, on the way; they may then cross other faces
};

struct SharpenedSurface {
  SurfaceMesh surface;              // vertices keep their numbers; some are no longer used
  std::vector<std::uint32_t> into;  // of each vertex, what it was pulled into; itself, where it stayed
  std::size_t pulls = 0;
};

// Where a sharp edge passes between outside nodes, contour() cuts it off: a strip of faces runs from a plane of the
// mesh to another one, or to several at a corner, and lies in none of them. Each two neighbours on different sides of
// such a strip become one vertex where their planes meet, if that is a point of the mesh. Faces in planes of the mesh
// stay in them and keep their fronts; what is left of strips vanishes between them. Vertices of `kept` stay, and all do
// where less than nine of ten faces are in planes. Whether faces intersect now, or nodes have changed sides, is not
// looked at. The same for any number of threads. Needs DefaultFloatingPoint. Precondition: sources are triangles of
// `input`, or kHole.
[[nodiscard]] SharpenedSurface sharpened(const SurfaceMesh& surface, const TriangleMesh& input,
                                         const std::vector<bool>& kept, const SharpenLimits& limits);

}  // namespace raycone
