// The faces of a mesh, each once.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// One of several faces with the same three positions.
struct FaceCopy {
  std::uint32_t unique;  // which of the unique faces it is
  std::uint32_t face;    // its place in the mesh
  bool as_first;         // runs around the corners as the first one does
};

struct UniqueFaces {
  std::vector<Triangle> corners;     // of three different positions, by representative vertices, as first stored
  std::vector<std::uint32_t> first;  // the place of that face in the mesh
  // How most copies are stored: 1 as the first one, -1 the other way round, 0 if there are as many of either: no
  // opinion.
  std::vector<std::int8_t> vote;
  std::vector<FaceCopy> copies;  // of those that are there more than once, the first ones too; by unique, then face
};

// The faces of `mesh` but for those with two corners at one position. `position[v]` is the vertex that stands for all
// vertices at the place of v (core/mesh/equal_vertices.h). Takes time in proportion to the mesh. Uses the threads that
// ThreadLimit allows.
[[nodiscard]] UniqueFaces unique_faces(const TriangleMesh& mesh, const std::vector<std::uint32_t>& position);

}  // namespace raycone
