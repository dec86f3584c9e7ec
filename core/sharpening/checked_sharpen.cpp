#include "core/sharpening/checked_sharpen.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/cells/node_set.h"
#include "core/certificate/certificate.h"
#include "core/certificate/fault_places.h"
#include "core/certificate/surface_edit.h"
#include "core/machine/threads.h"
#include "core/sharpening/corner_gaps.h"
#include "core/sharpening/lattice_crossings.h"

namespace raycone {
namespace {

// Looks where a surface crosses mixed edges of the lattice off the mesh: there the lattice looked, and the surface was
// right before.
class MixedEdges {
 public:
  MixedEdges(const SharpenInput& input, const NodeSet& inside, const SharpenLimits& limits)
      : input_(input), inside_(inside), lattice_(inside.lattice()), limits_(limits) {}

  // The vertices that were pulled off such an edge, where a face has come to cross it off the mesh since; of faces that
  // cross another one, those that were pulled. Without what fill_corner_gaps() will mend: the first call finds out
  // where it does.
  [[nodiscard]] std::vector<std::uint32_t> vertices_off(const SurfaceMesh& surface, const SurfaceEdit& change) {
    const std::vector<FaceOff> off = faces_off(surface, change);
    if (off.empty()) return {};
    if (!mended_) find_mended(surface, off);
    const std::map<Edge, std::vector<std::uint32_t>> pulled_off = pulled_off_edges(change);
    std::vector<bool> has_moved(surface.mesh.vertices.size(), false);
    for (const std::uint32_t v : change.vertices) has_moved[v] = true;
    std::vector<std::uint32_t> vertices;
    for (const auto& [t, points] : off) {
      for (const Vec3& p : points) {
        if (is_beside(p, *mended_) && !is_beside(p, *left_)) continue;
        const std::size_t before = vertices.size();
        for (const Edge& edge : edges_at(p)) {
          if (const auto at = pulled_off.find(edge); at != pulled_off.end())
            vertices.insert(vertices.end(), at->second.begin(), at->second.end());
        }
        if (vertices.size() > before) continue;
        std::ranges::copy_if(t, std::back_inserter(vertices), [&](std::uint32_t v) { return has_moved[v]; });
        if (vertices.size() == before) vertices.insert(vertices.end(), t.begin(), t.end());
      }
    }
    return vertices;
  }

 private:
  using Edge = std::array<std::int64_t, 4>;  // its axis, and its lower end

  [[nodiscard]] bool holds(const Edge& edge, std::size_t up) const {
    std::array<std::int64_t, 3> node;
    for (std::size_t a = 0; a < 3; ++a) node[a] = edge[a + 1] - lattice_.index_min[a];
    node[static_cast<std::size_t>(edge[0])] += static_cast<std::int64_t>(up);
    for (std::size_t a = 0; a < 3; ++a) {
      if (node[a] < 0 || node[a] >= lattice_.counts[a]) return false;
    }
    return inside_.holds(node[0], node[1], node[2]);
  }

  [[nodiscard]] bool is_on_mixed_edge(const Vec3& p) const {
    return std::ranges::any_of(edges_at(p), [&](const Edge& edge) { return holds(edge, 0) != holds(edge, 1); });
  }

  // The edges that a point is on, up to margins.
  [[nodiscard]] std::vector<Edge> edges_at(const Vec3& p) const {
    Edge near{0, 0, 0, 0}, cell{0, 0, 0, 0};
    std::array<bool, 3> is_level;
    for (std::size_t a = 0; a < 3; ++a) {
      const int axis = static_cast<int>(a);
      const double index = lattice_.index_at(axis, p[axis]);
      near[a + 1] = std::llround(index);
      cell[a + 1] = static_cast<std::int64_t>(std::floor(index));
      is_level[a] = std::abs(p[axis] - lattice_.coordinate(axis, near[a + 1])) <= limits_.off;
    }
    std::vector<Edge> edges;
    for (std::size_t a = 0; a < 3; ++a) {
      if (!is_level[(a + 1) % 3] || !is_level[(a + 2) % 3]) continue;
      edges.push_back(near);
      edges.back()[0] = static_cast<std::int64_t>(a);
      edges.back()[a + 1] = cell[a + 1];
    }
    return edges;
  }

  [[nodiscard]] std::map<Edge, std::vector<std::uint32_t>> pulled_off_edges(const SurfaceEdit& change) const {
    std::map<Edge, std::vector<std::uint32_t>> pulled;
    for (std::size_t n = 0; n < change.vertices.size(); ++n) {
      for (const Edge& edge : edges_at(change.places[n].before)) pulled[edge].push_back(change.vertices[n]);
    }
    return pulled;
  }

  struct FaceOff {
    Triangle t;
    std::vector<Vec3> points;
  };

  [[nodiscard]] std::vector<Vec3> points_off(const SurfaceMesh& surface, std::uint32_t face) const {
    const Triangle& t = surface.mesh.triangles[face];
    if (is_gone(t) || surface.sources[face] == kHole) return {};
    const std::vector<Vec3>& vertices = surface.mesh.vertices;
    std::vector<Vec3> points =
        crossings_off_mesh({vertices[t[0]], vertices[t[1]], vertices[t[2]]}, lattice_, input_.distance, limits_.off);
    std::erase_if(points, [&](const Vec3& p) { return !is_on_mixed_edge(p); });
    return points;
  }

  [[nodiscard]] std::vector<FaceOff> faces_off(const SurfaceMesh& surface, const SurfaceEdit& change) const {
    std::vector<std::vector<Vec3>> points(change.faces.size());
    parallel_for_each(points.size(), 64, [&](std::size_t n) { points[n] = points_off(surface, change.faces[n]); });
    std::vector<FaceOff> off;
    for (std::size_t n = 0; n < points.size(); ++n) {
      if (!points[n].empty()) off.push_back({surface.mesh.triangles[change.faces[n]], std::move(points[n])});
    }
    return off;
  }

  void find_mended(const SurfaceMesh& surface, const std::vector<FaceOff>& off) {
    mended_.emplace(lattice_);
    left_.emplace(lattice_);
    for (const FaceOff& face : off) add_corners(face.points, *mended_);
    SurfaceMesh filled = surface;
    drop_gone(filled);
    left_ = fill_corner_gaps(filled, input_, lattice_, limits_) ? nodes_off(filled, *mended_) : mended_;
  }

  // Of the cells that the points are in.
  void add_corners(const std::vector<Vec3>& points, NodeSet& nodes) const {
    for (const Vec3& p : points) {
      for (const NodeSet::Node& node : corners_of_cell_at(p, lattice_)) nodes.insert(node[0], node[1], node[2]);
    }
  }

  // The corners of cells where faces beside `nodes` do so.
  [[nodiscard]] NodeSet nodes_off(const SurfaceMesh& surface, const NodeSet& nodes) const {
    const std::vector<bool> beside = faces_beside(surface.mesh.vertices, surface.mesh.triangles, nodes);
    NodeSet found(lattice_);
    for (std::uint32_t face = 0; face < beside.size(); ++face) {
      if (beside[face]) add_corners(points_off(surface, face), found);
    }
    return found;
  }

  const SharpenInput& input_;
  const NodeSet& inside_;
  const Lattice& lattice_;
  const SharpenLimits& limits_;
  // The corners of cells where faces were off at first, and of those where they still are once corners are filled.
  std::optional<NodeSet> mended_, left_;
};

}  // namespace

bool checked_sharpen(SurfaceMesh& surface, const SharpenInput& input, const NodeSet& inside,
                     const SharpenLimits& limits, int rounds) {
  constexpr int kPartialRounds = 6;
  const Lattice& lattice = inside.lattice();
  Sharpener sharpener(surface, input, limits);
  SurfaceEdit change = sharpener.sharpen();
  MixedEdges edges(input, inside, limits);
  NodeSet misplaced(lattice);
  for (int round = 0; round < rounds && sharpener.pulls() > 0; ++round) {
    NearFaults near = faults_near(surface.mesh, change, lattice);
    misplaced.flip(changed_nodes(surface.mesh, change, lattice));
    using Kept = Sharpener::Kept;
    if (near.faults.none() && misplaced.empty()) {
      const std::vector<std::uint32_t> off = edges.vertices_off(surface, sharpener.all_changes());
      if (off.empty()) {
        sharpener.finish();
        return true;
      }
      change = sharpener.keep(off, round < kPartialRounds ? Kept::kPulledOffMesh : Kept::kStrips);
      if (change.changes_nothing()) break;
      continue;
    }
    sharpener.for_each_target([&](std::uint32_t vertex, const Vec3& p) {
      if (is_beside(p, misplaced)) near.vertices.push_back(vertex);
    });
    change = sharpener.keep(near.vertices, round < kPartialRounds ? Kept::kPulled : Kept::kStrips);
    if (change.changes_nothing()) break;  // such faults do not come from pulls
  }
  sharpener.undo();
  return false;
}

}  // namespace raycone
