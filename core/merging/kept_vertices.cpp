#include "core/merging/kept_vertices.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/certificate/fault_places.h"
#include "core/exact/predicates.h"

namespace raycone {
namespace {

using Node = NodeSet::Node;

// The nodes that are at most `reach` from one of `nodes` along an axis, too. Where merging moves an edge of the surface
// over a node that it leads through, it does so at any other node that the edge leads through.
NodeSet along_axes(const NodeSet& nodes, std::int64_t reach) {
  NodeSet result = nodes;
  const auto spread = [&](const Node& node) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Node at = node;
      const std::int64_t end = std::min(node[axis] + reach, nodes.lattice().counts[axis] - 1);
      for (at[axis] = std::max<std::int64_t>(node[axis] - reach, 0); at[axis] <= end; ++at[axis])
        result.insert(at[0], at[1], at[2]);
    }
  };
  nodes.for_each(spread);
  return result;
}

// Along the axis where that is most.
double voxels_between(const Vec3& p, const Vec3& q, const Lattice& lattice) {
  const Vec3& h = lattice.spacing;
  return std::max({std::abs(p.x - q.x) / h.x, std::abs(p.y - q.y) / h.y, std::abs(p.z - q.z) / h.z});
}

}  // namespace

void KeptVertices::keep(std::span<const std::uint32_t> vertices) {
  for (const std::uint32_t v : vertices) kept_[v] = true;
}

bool KeptVertices::keep_more(const FaultyMerge& found, int round) {
  constexpr double kFirstReach = 0.25;  // voxels; then 1, 2, 4, ...
  const bool any_home = keep_at_home(found);
  if (round >= kRounds) return keep_around(found, round - kRounds) || any_home;
  return keep_near(found, round == 0 ? kFirstReach : std::exp2(round - 1)) || any_home;
}

// Faces of points that are kept may have faults because these were moved.
bool KeptVertices::keep_at_home(const FaultyMerge& found) {
  const std::vector<bool> touched = vertices_at_faults(found);
  bool is_more = false;
  for (std::size_t v = 0; v < kept_.size(); ++v) {
    if (!touched[v] || !kept_[v] || at_home_[v]) continue;
    at_home_[v] = is_more = true;
  }
  return is_more;
}

template <class MayStay>
bool KeptVertices::keep_where(const MayStay& may_stay) {
  bool is_more = false;
  for (std::size_t v = 0; v < kept_.size(); ++v) {
    if (kept_[v] || !may_stay(v)) continue;
    kept_[v] = is_more = true;
  }
  return is_more;
}

// The vertices of faces that intersect others, or have no area.
std::vector<bool> KeptVertices::vertices_at_faults(const FaultyMerge& found) const {
  std::vector<bool> touched = faulty_vertices(kept_.size(), found.merged.triangles, found.faults);
  for (std::size_t face = 0; face < found.merged.triangles.size() && found.faults.degenerate_faces > 0; ++face) {
    const Triangle& t = found.mesh.triangles[face];
    if (!collinear(found.mesh.vertices[t[0]], found.mesh.vertices[t[1]], found.mesh.vertices[t[2]])) continue;
    for (const std::uint32_t corner : found.merged.triangles[face]) touched[corner] = true;
  }
  return touched;
}

// Large faces are undone near the vertices that they have left, first: `most` voxels from them.
bool KeptVertices::keep_near(const FaultyMerge& found, double most) {
  const std::vector<Vec3>& vertices = surface_->mesh.vertices;
  const std::vector<bool> touched = vertices_at_faults(found);
  const bool has_misplaced = found.faults.nodes > 0;
  const Lattice& lattice = found.misplaced.lattice();
  return keep_where([&](std::size_t v) {
    const std::uint32_t into = found.merged.into[v];
    const bool undone = touched[into] && voxels_between(vertices[v], vertices[into], lattice) <= most;
    return undone || (has_misplaced && is_beside(vertices[v], found.misplaced));
  });
}

// Each time more: all that was pulled into faces with faults and into those around them, in twice as many rings; what
// is beside nodes on the lines of misplaced ones, four times as far. At last, misplaced nodes are faults of the faces
// next to them.
bool KeptVertices::keep_around(const FaultyMerge& found, int wide) {
  constexpr int kFacesFrom = 4;
  const std::vector<Vec3>& vertices = surface_->mesh.vertices;
  std::vector<bool> touched = vertices_at_faults(found);
  if (wide >= kFacesFrom) touch_faces_beside(vertices, found.merged.triangles, found.misplaced, touched);
  for (int ring = 0; ring < 1 << wide; ++ring) {
    std::vector<bool> wider = touched;
    for (const Triangle& t : found.merged.triangles) {
      if (!touched[t[0]] && !touched[t[1]] && !touched[t[2]]) continue;
      for (const std::uint32_t corner : t) wider[corner] = true;
    }
    touched = std::move(wider);
  }
  const NodeSet lines = along_axes(found.misplaced, std::int64_t{2} << 2 * wide);
  return keep_where([&](std::size_t v) { return touched[found.merged.into[v]] || is_beside(vertices[v], lines); });
}

}  // namespace raycone
