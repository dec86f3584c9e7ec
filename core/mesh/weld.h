// Merges vertices that have the same position.
#pragma once

#include "core/data/triangle_mesh.h"

namespace raycone {

enum class WeldMode { kExact, kNone, kDistance };

struct Weld {
  WeldMode mode = WeldMode::kExact;
  double distance = 0.0;  // world units; only for kDistance, positive and finite
};

// The mesh with -0 stored as +0, and with equal vertices merged into representatives:
//
//   kNone      none are merged
//   kExact     those of bitwise equal coordinates
//   kDistance  in lexicographic order of (x, y, z), a vertex joins the first earlier representative within `distance`,
//              or becomes one; distances are as std::hypot() gives them, and vertices that are not finite join nobody
//
// Triangles keep their number and order. The result does not depend on the order of faces, with kDistance not on that
// of vertices either. n vertices take time in proportion to n, with kDistance to n log n, wherever they lie. Uses the
// threads that ThreadLimit allows. Precondition: indices are in range.
[[nodiscard]] TriangleMesh weld(TriangleMesh mesh, const Weld& how);

}  // namespace raycone
