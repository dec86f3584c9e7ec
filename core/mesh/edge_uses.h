// How triangles use the edges of a mesh.
#pragma once

#include <cstdint>
#include <functional>

#include "core/data/triangle_mesh.h"

namespace raycone {

// How often triangles traverse the undirected edge {low, high}, low < high (vertex indices).
struct EdgeUse {
  std::uint32_t low = 0;
  std::uint32_t high = 0;
  std::uint32_t forward = 0;   // from low to high
  std::uint32_t backward = 0;  // from high to low

  [[nodiscard]] std::uint64_t uses() const { return std::uint64_t{forward} + backward; }
  [[nodiscard]] bool is_exterior() const { return forward != backward; }                     // faces do not cancel
  [[nodiscard]] bool is_nonmanifold() const { return uses() > 2; }                           // more than two faces
  [[nodiscard]] bool is_inconsistent() const { return uses() == 2 && forward != backward; }  // two, same direction
};

// Calls visit once for each undirected edge between two different vertices, by increasing low, then high. An edge that
// one triangle traverses in both directions (two equal corners) counts in both.
void for_each_edge(const TriangleMesh& mesh, const std::function<void(const EdgeUse&)>& visit);

}  // namespace raycone
