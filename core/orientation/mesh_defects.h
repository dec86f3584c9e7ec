// What makes the winding numbers of a mesh other than its owner expects, although they are right.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/mesh/exterior_edges.h"

namespace raycone {

struct MeshDefects {
  std::uint64_t inconsistent_edges = 0;  // edges of exactly two faces that run along them in the same direction
  std::uint64_t cancelling_pairs = 0;    // pairs of faces with the same three vertices and opposite orientations
  // Components (faces joined through vertices) that are closed, have a negative volume, and do not lie within another
  // closed component (nesting.h): a cavity is none. One of negative volume is split where its faces meet only at
  // vertices, and each part looked at by itself; one of positive volume is not.
  std::uint64_t reversed_components = 0;
  bool negative_volume = false;  // the mesh as a whole is closed, and its volume is negative
};

// Defects of a welded mesh with these exterior_edges(), which noted all triangles in `links`. Signs of volumes are
// exact: that of a double-sided sheet is 0, and not negative. Where floating point cannot vouch for one, this takes
// some microseconds for each face that has no opposite. The result does not depend on the order of faces, nor on the
// number of threads. Precondition: all vertices of triangles finite. Uses the threads that ThreadLimit allows.
[[nodiscard]] MeshDefects mesh_defects(const TriangleMesh& welded, const std::vector<ExteriorEdge>& edges,
                                       const VertexLinks& links);

}  // namespace raycone
