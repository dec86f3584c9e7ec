#include "core/mesh/face_edges.h"

#include <algorithm>
#include <tuple>

namespace raycone {

std::vector<FaceEdge> face_edges(const std::vector<Triangle>& triangles) {
  std::vector<FaceEdge> edges;
  edges.reserve(3 * triangles.size());
  for (std::uint32_t face = 0; face < triangles.size(); ++face) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = triangles[face][i], to = triangles[face][(i + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), face, from < to});
    }
  }
  std::ranges::sort(edges, {}, [](const FaceEdge& e) { return std::tie(e.low, e.high, e.face); });
  return edges;
}

}  // namespace raycone
