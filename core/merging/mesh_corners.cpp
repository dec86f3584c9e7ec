#include "core/merging/mesh_corners.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace raycone {
namespace {

// Points by the cells of a lattice that they are in; those outside of it count as in its outermost cells.
class PointsInCells {
 public:
  PointsInCells(const Lattice& lattice, const std::vector<Vec3>& points) : lattice_(lattice) {
    places_.reserve(points.size());
    for (std::uint32_t n = 0; n < points.size(); ++n) places_.emplace_back(cell_at(points[n]), n);
    std::ranges::sort(places_);
  }

  // Calls visit(point) for all within `reach` of p, and more.
  template <class Visit>
  void for_each_near(const Vec3& p, double reach, const Visit& visit) const {
    std::array<std::int64_t, 8> cells;
    for (unsigned corner = 0; corner < cells.size(); ++corner) {
      const auto moved = [&](double x, unsigned axis) { return (corner >> axis & 1U) != 0 ? x + reach : x - reach; };
      cells[corner] = cell_at({moved(p.x, 0), moved(p.y, 1), moved(p.z, 2)});
    }
    std::ranges::sort(cells);
    for (const auto* cell = cells.begin(); cell != cells.end(); ++cell) {
      if (cell != cells.begin() && *cell == cell[-1]) continue;
      auto place = std::ranges::lower_bound(places_, std::pair(*cell, std::uint32_t{0}));
      for (; place != places_.end() && place->first == *cell; ++place) visit(place->second);
    }
  }

 private:
  [[nodiscard]] std::int64_t cell_at(const Vec3& p) const {
    std::int64_t cell = 0;
    for (int axis = 2; axis >= 0; --axis) {
      const auto a = static_cast<std::size_t>(axis);
      const std::int64_t along = lattice_.cell_at(axis, p[axis]);
      cell = cell * lattice_.counts[a] + std::clamp<std::int64_t>(along, 0, lattice_.counts[a] - 1);
    }
    return cell;
  }

  const Lattice& lattice_;
  std::vector<std::pair<std::int64_t, std::uint32_t>> places_;
};

std::vector<Vec3> used_vertices(const TriangleMesh& mesh) {
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t corner : t) used[corner] = true;
  }
  std::vector<Vec3> vertices;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v]) vertices.push_back(mesh.vertices[v]);
  }
  return vertices;
}

}  // namespace

void move_to_corners(const TriangleMesh& input, const Lattice& lattice, double reach, std::vector<Vec3>& vertices) {
  const PointsInCells places(lattice, vertices);
  struct Move {
    std::uint32_t vertex;
    double square;  // of the way
    Vec3 to;
  };
  std::vector<Move> moves;  // where nothing has moved yet
  for (const Vec3& corner : used_vertices(input)) {
    double least = reach * reach;
    std::uint32_t nearest = UINT32_MAX;
    places.for_each_near(corner, reach, [&](std::uint32_t v) {
      const Vec3 off = vertices[v] - corner;
      const double square = dot(off, off);
      if (!(square < least || (square == least && v < nearest))) return;
      least = square;
      nearest = v;
    });
    if (nearest != UINT32_MAX) moves.push_back({nearest, least, corner});
  }
  // Of several corners near one vertex the nearest has it.
  std::ranges::stable_sort(moves, {}, [](const Move& move) { return std::pair(move.vertex, move.square); });
  std::uint32_t last = UINT32_MAX;
  for (const Move& move : moves) {
    if (move.vertex != last) vertices[move.vertex] = move.to;
    last = move.vertex;
  }
}

void move_into_level_planes(const TriangleMesh& input, const std::vector<std::int32_t>& sources, double reach,
                            TriangleMesh& surface) {
  for (std::size_t face = 0; face < surface.triangles.size(); ++face) {
    if (sources[face] < 0) continue;
    const Triangle& source = input.triangles[static_cast<std::size_t>(sources[face])];
    const Vec3 &a = input.vertices[source[0]], &b = input.vertices[source[1]], &c = input.vertices[source[2]];
    for (int axis = 0; axis < 3; ++axis) {
      if (a[axis] != b[axis] || a[axis] != c[axis]) continue;
      for (const std::uint32_t corner : surface.triangles[face]) {
        double& here = surface.vertices[corner][axis];
        if (std::abs(here - a[axis]) <= reach) here = a[axis];
      }
    }
  }
}

void move_points(PointMoves moves, const TriangleMesh& input, const std::vector<std::int32_t>& sources,
                 const Lattice& lattice, double reach, TriangleMesh& surface) {
  if (moves == PointMoves::kNone) return;
  const std::vector<Vec3> before = surface.vertices;
  if (moves == PointMoves::kIntoLevelPlanes) move_into_level_planes(input, sources, reach, surface);
  move_to_corners(input, lattice, reach, surface.vertices);
  for (std::size_t v = 0; v < before.size(); ++v) {
    const Vec3 step = surface.vertices[v] - before[v];
    if (!(dot(step, step) <= reach * reach)) surface.vertices[v] = before[v];  // several planes may have moved it
  }
}

}  // namespace raycone
