// Faces around a vertex that cannot intersect each other.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/data/vec3.h"

namespace raycone {

// Two corners of a face at a vertex: the next one after the vertex, and the last.
using FanStep = std::pair<std::uint32_t, std::uint32_t>;

// Whether the faces around a vertex are surely a graph over a plane: seen along one direction, all of them from their
// fronts and once around the vertex. No two of them then meet but in what they share. Precondition: they are one cycle
// (`steps` in any order). False, too, where floating point is not sure. Needs DefaultFloatingPoint. Thread-safe.
[[nodiscard]] bool is_surely_graph(const std::vector<Vec3>& vertices, std::uint32_t vertex,
                                   std::span<const FanStep> steps);

}  // namespace raycone
