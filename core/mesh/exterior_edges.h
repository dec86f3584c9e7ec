// The edges that the boundary of a mesh consists of.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/mesh/vertex_links.h"

namespace raycone {

// An exterior edge: the boundary of the mesh, as a sum of directed edges, holds from -> to `multiplicity` times (not 0;
// negative: to -> from). Jacobson, Kavan, Sorkine-Hornung 2013, section 4.2.
struct ExteriorEdge {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  std::int32_t multiplicity = 0;
};

// All exterior edges of a welded mesh, by increasing |multiplicity|, those of one |multiplicity| strung into chains (an
// edge's `to` is the next one's `from` wherever possible). Order and directions depend on the coordinates of the edges
// only, and but for the signs of the multiplicities not on the orientation of the mesh. If `links` are given, with
// nothing noted yet, all triangles are noted there on the way. Uses the threads that ThreadLimit allows.
[[nodiscard]] std::vector<ExteriorEdge> exterior_edges(const TriangleMesh& mesh, VertexLinks* links = nullptr);

}  // namespace raycone
