#include "core/surface/fault_places.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "core/surface/kuhn.h"
#include "core/surface/surface_cells.h"

namespace raycone {

std::vector<bool> faulty_vertices(std::size_t count, const std::vector<Triangle>& triangles,
                                  const SurfaceFaults& faults) {
  const std::vector<bool>& faulty = faults.intersections.of_triangle;
  std::vector<bool> vertices(count, false);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (!faulty[i]) continue;
    for (const std::uint32_t corner : triangles[i]) vertices[corner] = true;
  }
  return vertices;
}

bool is_beside(const Vec3& p, const NodeSet& nodes) {
  const Lattice& lattice = nodes.lattice();
  std::array<std::int64_t, 3> cell;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    cell[a] = std::clamp<std::int64_t>(lattice.cell_at(axis, p[axis]), 0, lattice.counts[a] - 2);
  }
  for (unsigned corner = 0; corner < kuhn::kCorners; ++corner) {
    const auto [i, j, k] = SurfaceCells::node_at({cell, 0, 0}, corner);
    if (nodes.holds(i, j, k)) return true;
  }
  return false;
}

TriangleMesh used_part(const std::vector<Vec3>& vertices, std::vector<Triangle> triangles) {
  constexpr std::uint32_t kUnused = 0xFFFFFFFF;
  std::vector<std::uint32_t> number(vertices.size(), kUnused);
  std::uint32_t count = 0;
  for (Triangle& t : triangles) {
    for (std::uint32_t& corner : t) {
      if (number[corner] == kUnused) number[corner] = count++;
      corner = number[corner];
    }
  }
  TriangleMesh used{std::vector<Vec3>(count), std::move(triangles)};
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (number[v] != kUnused) used.vertices[number[v]] = vertices[v];
  }
  return used;
}

}  // namespace raycone
