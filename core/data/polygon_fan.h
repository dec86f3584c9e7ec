// A polygon as readers hand it over: a fan of triangles, in which its corners can still be read.
#pragma once

#include <cstdint>

namespace raycone {

// The polygon with the corners c0, c1, ..., c(n-1), n >= 4, that the n - 2 triangles (c0, c1, c2), (c0, c2, c3), ... of
// TriangleMesh::triangles stand for, the first of them at index `first`.
struct PolygonFan {
  std::uint64_t first = 0;
  std::uint64_t triangles = 0;

  friend bool operator==(const PolygonFan&, const PolygonFan&) = default;
};

}  // namespace raycone
