// Triangles in an order in which those that are near each other are near.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// All triangles of a mesh along Morton's curve through the cubes of 1/2048 of its size; within a cube by number. By the
// middles of their boxes. Sooner done than runs that medians cut (core/mesh/triangle_runs.h), and by all threads that
// ThreadLimit allows. Precondition: the vertices that triangles use are finite, at most kMaxTriangles triangles.
[[nodiscard]] std::vector<std::uint32_t> triangles_along_curve(const TriangleMesh& mesh);

}  // namespace raycone
