// Triangles of a mesh that intersect each other.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// Indices of two triangles, the lower one first.
using TrianglePair = std::array<std::uint32_t, 2>;

struct SelfIntersections {
  std::uint64_t pairs = 0;
  std::optional<TrianglePair> first;  // in the order of the search
  std::vector<bool> of_triangle;      // whether a triangle is in a pair
};

// How triangles are sorted for the search. Only `first` depends on it, and the time.
enum class SearchOrder {
  kRuns,   // in runs that medians cut, whatever their sizes and places
  kCurve,  // along a curve through 2048^3 equal cubes: sooner where sizes are much the same, as on surfaces of
           // lattices. Triangles of one cube go by number; beside one far away, all others may be in one
};

// The pairs of triangles that meet_beyond_shared() (core/intersections/triangle_pair.h). Exact. The same for any number
// of threads, and but for `first` for any order of triangles. Takes n log n time where few boxes of triangles meet, and
// a time in proportion to the pairs of boxes that meet, which may be n^2 / 2; memory in proportion to n. Uses the
// threads that ThreadLimit allows. `graphs`: of each vertex whether it is known that its triangles meet in nothing but
// what they share, as is_surely_graph() (vertex_graph.h) tells; pairs at such vertices are not looked at. `of`: not 0
// for triangles of which pairs are looked for, with any others. Precondition: the vertices that triangles use are
// finite, at most kMaxTriangles triangles.
[[nodiscard]] SelfIntersections self_intersections(const TriangleMesh& mesh, SearchOrder order = SearchOrder::kRuns,
                                                   const std::vector<std::uint8_t>* graphs = nullptr,
                                                   const std::vector<std::uint8_t>* of = nullptr);

// All of these pairs, in increasing order; none if they are more than `most`. The search ends there.
[[nodiscard]] std::optional<std::vector<TrianglePair>> intersecting_pairs(const TriangleMesh& mesh, std::size_t most);

// The `first` of these pairs alone, in runs. The search ends with it.
[[nodiscard]] std::optional<TrianglePair> first_self_intersection(const TriangleMesh& mesh,
                                                                  const std::vector<std::uint8_t>* graphs = nullptr);

}  // namespace raycone
