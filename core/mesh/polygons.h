// Polygons of a mesh to triangles that stay inside them.
#pragma once

#include <cstdint>
#include <span>

#include "core/data/polygon_fan.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// Each polygon is seen along its area vector, the sum of c(i) x c(i+1), rounded to doubles; all decisions are exact
// signs in that projection (docs/method.md, "Polygons").
// - Convex (corners in a straight line and repeated ones allowed): keeps its fan.
// - Simple but not convex: its triangles are replaced by others that cover it once. Simple means that its edges cross
//   nowhere but at corners and that it winds around every point 0 or 1 times, so it may touch itself, as where a bridge
//   leads to a hole.
//   Triangles of zero area join corners that lie on other edges to them, so that the boundary stays what it was.
// - All others keep their fans.
// A polygon may become fewer triangles than it had: `places`, indices of triangles in increasing order with which no
// fan but a whole one begins, are moved to where these are then. Returns the number of the last kind. The `fans` are in
// increasing order and disjoint; all their vertices finite. The result does not depend on the number of threads. Time
// as of cut_polygon(). Throws ThreadsUnavailable.
std::uint64_t cut_concave_polygons(TriangleMesh& mesh, std::span<const PolygonFan> fans,
                                   std::span<std::uint64_t> places = {});

}  // namespace raycone
