#include "core/certificate/fault_places.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/cells/kuhn.h"
#include "core/cells/surface_cells.h"

namespace raycone {
namespace {

using Node = NodeSet::Node;

// `nodes` are in the order of NodeSet.
bool is_near(const std::vector<Vec3>& vertices, const Triangle& t, const Lattice& lattice,
             const std::vector<Node>& nodes) {
  Node low{}, high{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const auto [least, most] = std::minmax({vertices[t[0]][axis], vertices[t[1]][axis], vertices[t[2]][axis]});
    low[a] = lattice.cell_at(axis, least) - 1;
    high[a] = lattice.cell_at(axis, most) + 2;
  }
  const auto layer = [](const Node& node) { return node[2]; };
  const auto begin = std::ranges::lower_bound(nodes, low[2], {}, layer);
  const auto end = std::ranges::upper_bound(nodes, high[2], {}, layer);
  return std::any_of(begin, end, [&](const Node& node) {
    return low[0] <= node[0] && node[0] <= high[0] && low[1] <= node[1] && node[1] <= high[1];
  });
}

}  // namespace

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

std::array<Node, 8> corners_of_cell_at(const Vec3& p, const Lattice& lattice) {
  Node cell;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    cell[a] = std::clamp<std::int64_t>(lattice.cell_at(axis, p[axis]), 0, lattice.counts[a] - 2);
  }
  std::array<Node, 8> corners;
  static_assert(kuhn::kCorners == corners.size());
  for (unsigned n = 0; n < kuhn::kCorners; ++n) corners[n] = SurfaceCells::node_at({cell, 0, 0}, n);
  return corners;
}

bool is_beside(const Vec3& p, const NodeSet& nodes) {
  return std::ranges::any_of(corners_of_cell_at(p, nodes.lattice()),
                             [&](const Node& node) { return nodes.holds(node[0], node[1], node[2]); });
}

std::vector<bool> faces_beside(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles,
                               const NodeSet& nodes) {
  std::vector<Node> sorted;
  nodes.for_each([&](const Node& node) { sorted.push_back(node); });
  std::vector<bool> beside(triangles.size(), false);
  for (std::size_t face = 0; face < triangles.size() && !sorted.empty(); ++face)
    beside[face] = is_near(vertices, triangles[face], nodes.lattice(), sorted);
  return beside;
}

void touch_faces_beside(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles, const NodeSet& nodes,
                        std::vector<bool>& touched) {
  const std::vector<bool> beside = faces_beside(vertices, triangles, nodes);
  for (std::size_t face = 0; face < triangles.size(); ++face) {
    if (!beside[face]) continue;
    for (const std::uint32_t corner : triangles[face]) touched[corner] = true;
  }
}

}  // namespace raycone
