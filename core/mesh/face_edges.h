// The edges of a mesh, with the faces at each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// An edge as one face has it.
struct FaceEdge {
  std::uint32_t low = 0;
  std::uint32_t high = 0;
  std::uint32_t face = 0;
  bool is_forward = false;  // from low to high, around the face

  [[nodiscard]] bool is_same_edge(const FaceEdge& other) const { return low == other.low && high == other.high; }
};

// Sorted by low, then high, then face; a triangle with two equal corners has its one edge twice. Uses the threads that
// ThreadLimit allows. Precondition: fewer than 2^32 triangles.
[[nodiscard]] std::vector<FaceEdge> face_edges(const std::vector<Triangle>& triangles);

// Calls visit(faces) for each edge, in this order, with those that have it. Of what face_edges() returns.
template <class Visit>
void for_each_edge(std::span<const FaceEdge> edges, const Visit& visit) {
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && edges[end].is_same_edge(edges[begin])) ++end;
    visit(edges.subspan(begin, end - begin));
  }
}

}  // namespace raycone
