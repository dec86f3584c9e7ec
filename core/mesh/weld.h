// Identification of vertices by position.
#pragma once

#include "core/data/triangle_mesh.h"

namespace raycone {

enum class WeldMode { kExact, kNone, kDistance };

struct Weld {
  WeldMode mode = WeldMode::kExact;
  double distance = 0.0;  // world units; only for kDistance, positive and finite
};

// The mesh with -0 stored as +0 and equal vertices merged: bitwise equal ones (kExact), or, for kDistance, greedily in
// lexicographic order of (x, y, z): a vertex joins the first earlier representative within `distance`, or becomes one.
// Triangles keep their number and order and refer to the representatives. The result does not depend on the order of
// faces, for kDistance nor on that of vertices; with kNone only the zeros change. Distances are rounded to double;
// vertices that are not finite are within none. For n vertices it takes a time of n, for kDistance n log n, however
// they were chosen. Uses the threads that ThreadLimit allows.
[[nodiscard]] TriangleMesh weld(TriangleMesh mesh, const Weld& how);

}  // namespace raycone
