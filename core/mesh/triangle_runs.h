// Triangles in the order of a search tree.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// The box of one triangle. Precondition: triangle < mesh.triangles.size().
[[nodiscard]] inline Box box_of_triangle(const TriangleMesh& mesh, std::uint32_t triangle) {
  return box_of(corners_of(mesh, mesh.triangles[triangle]));
}

// All triangles of the mesh, in runs of `width` that are close together, these in runs of `width` runs, and so on: they
// are split at medians along the axis that is about the longest, so that all runs but the last of a level are full.
// Where the middles of boxes tie, which are told apart to 2^-8 of what is split or better, however far away others are,
// the lower triangle comes first. The same for any number of threads; uses those that ThreadLimit allows. Precondition:
// the vertices that triangles use are finite, width >= 2.
[[nodiscard]] std::vector<std::uint32_t> triangles_in_runs(const TriangleMesh& mesh, std::size_t width);

}  // namespace raycone
