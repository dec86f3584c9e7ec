#include "core/sharpening/mixed_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <utility>

#include "core/certificate/fault_places.h"
#include "core/machine/threads.h"
#include "core/sharpening/corner_gaps.h"
#include "core/sharpening/lattice_crossings.h"

namespace raycone {
namespace {

// Of a lattice.
struct Edge {
  std::size_t axis;
  LatticeIndex lower;  // of its lower end
  auto operator<=>(const Edge&) const = default;
};

// The edges that a point is on; `off`: how far it may be from them.
std::vector<Edge> edges_at(const Vec3& p, const Lattice& lattice, double off) {
  LatticeIndex nearest, below;
  std::array<bool, 3> is_level;
  for (std::size_t a = 0; a < 3; ++a) {
    const int axis = static_cast<int>(a);
    const double index = lattice.index_at(axis, p[axis]);
    nearest[a] = std::llround(index);
    below[a] = static_cast<std::int64_t>(std::floor(index));
    is_level[a] = std::abs(p[axis] - lattice.coordinate(axis, nearest[a])) <= off;
  }
  std::vector<Edge> edges;
  for (std::size_t a = 0; a < 3; ++a) {
    if (!is_level[(a + 1) % 3] || !is_level[(a + 2) % 3]) continue;
    edges.push_back({a, nearest});
    edges.back().lower[a] = below[a];
  }
  return edges;
}

// By the edge that they were on before.
std::map<Edge, std::vector<std::uint32_t>> pulled_off_edges(const SurfaceEdit& change, const Lattice& lattice,
                                                            double off) {
  std::map<Edge, std::vector<std::uint32_t>> pulled;
  for (std::size_t n = 0; n < change.vertices.size(); ++n) {
    for (const Edge& edge : edges_at(change.places[n].before, lattice, off)) pulled[edge].push_back(change.vertices[n]);
  }
  return pulled;
}

bool holds(const NodeSet& nodes, const LatticeIndex& index) {
  const Lattice& lattice = nodes.lattice();
  const auto& [i, j, k] = lattice.index_min;
  return whole(lattice).holds(index) && nodes.holds(index[0] - i, index[1] - j, index[2] - k);
}

bool is_mixed(const Edge& edge, const NodeSet& inside) {
  LatticeIndex upper = edge.lower;
  ++upper[edge.axis];
  return holds(inside, edge.lower) != holds(inside, upper);
}

// Of the cells that the points are in.
void add_corners(const std::vector<Vec3>& points, NodeSet& nodes) {
  for (const Vec3& p : points) {
    for (const auto& [i, j, k] : corners_of_cell_at(p, nodes.lattice())) nodes.insert(i, j, k);
  }
}

}  // namespace

std::vector<std::uint32_t> MixedEdges::vertices_off(const SurfaceMesh& surface, const SurfaceEdit& change) {
  const std::vector<FaceOff> off = faces_off(surface, change);
  if (off.empty()) return {};
  if (!off_at_first_) find_mended(surface, off);
  const auto pulled_off = pulled_off_edges(change, lattice_, limits_.off);
  std::vector<bool> has_moved(surface.mesh.vertices.size(), false);
  for (const std::uint32_t v : change.vertices) has_moved[v] = true;
  std::vector<std::uint32_t> vertices;
  for (const auto& [t, points] : off) {
    for (const Vec3& p : points) {
      if (is_beside(p, *off_at_first_) && !is_beside(p, *off_when_filled_)) continue;
      const std::size_t before = vertices.size();
      for (const Edge& edge : edges_at(p, lattice_, limits_.off)) {
        const auto at = pulled_off.find(edge);
        if (at != pulled_off.end()) vertices.insert(vertices.end(), at->second.begin(), at->second.end());
      }
      if (vertices.size() > before) continue;
      std::ranges::copy_if(t, std::back_inserter(vertices), [&](std::uint32_t v) { return has_moved[v]; });
      if (vertices.size() == before) vertices.insert(vertices.end(), t.begin(), t.end());
    }
  }
  return vertices;
}

std::vector<Vec3> MixedEdges::points_off(const SurfaceMesh& surface, std::uint32_t face) const {
  const Triangle& t = surface.mesh.triangles[face];
  if (is_gone(t) || surface.sources[face] == kHole) return {};
  const std::vector<Vec3>& vertices = surface.mesh.vertices;
  std::vector<Vec3> points = crossings_off_mesh(corners_of(vertices, t), lattice_, input_.distance, limits_.off);
  std::erase_if(points, [&](const Vec3& p) {
    return std::ranges::none_of(edges_at(p, lattice_, limits_.off),
                                [&](const Edge& edge) { return is_mixed(edge, inside_); });
  });
  return points;
}

std::vector<MixedEdges::FaceOff> MixedEdges::faces_off(const SurfaceMesh& surface, const SurfaceEdit& change) const {
  std::vector<std::vector<Vec3>> points(change.faces.size());
  parallel_for_each(points.size(), 64, [&](std::size_t n) { points[n] = points_off(surface, change.faces[n]); });
  std::vector<FaceOff> off;
  for (std::size_t n = 0; n < points.size(); ++n) {
    if (!points[n].empty()) off.push_back({surface.mesh.triangles[change.faces[n]], std::move(points[n])});
  }
  return off;
}

// The corners of cells where faces beside these nodes are off.
NodeSet MixedEdges::nodes_off(const SurfaceMesh& surface, const NodeSet& beside) const {
  const std::vector<bool> is_looked_at = faces_beside(surface.mesh.vertices, surface.mesh.triangles, beside);
  NodeSet found(lattice_);
  for (std::uint32_t face = 0; face < is_looked_at.size(); ++face) {
    if (is_looked_at[face]) add_corners(points_off(surface, face), found);
  }
  return found;
}

void MixedEdges::find_mended(const SurfaceMesh& surface, const std::vector<FaceOff>& off) {
  off_at_first_.emplace(lattice_);
  for (const FaceOff& face : off) add_corners(face.points, *off_at_first_);
  SurfaceMesh filled = surface;
  drop_gone(filled);
  const bool any = fill_corner_gaps(filled, input_, lattice_, limits_);
  off_when_filled_ = any ? nodes_off(filled, *off_at_first_) : *off_at_first_;
}

}  // namespace raycone
