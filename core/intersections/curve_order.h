// The triangles of a mesh, sorted so that neighbours in space are neighbours in the order, as a rule.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// All triangles of a mesh along Morton's curve through the cubes of 1/2048 of its size, by the middles of their boxes;
// within a cube by number. Sooner done than runs that medians cut (core/mesh/triangle_runs.h). Uses the threads that
// ThreadLimit allows. Precondition: the vertices that triangles use are finite, at most kMaxTriangles triangles.
[[nodiscard]] std::vector<std::uint32_t> triangles_along_curve(const TriangleMesh& mesh);

}  // namespace raycone
