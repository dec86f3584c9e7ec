#include "core/surface/checked_merge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/exact/predicates.h"
#include "core/surface/certificate.h"
#include "core/surface/fault_places.h"
#include "core/surface/merge_planes.h"
#include "core/surface/mesh_corners.h"
#include "core/surface/repeated_check.h"
#include "core/surface/source_plane.h"

namespace raycone {
namespace {

// Near faults, vertices are kept for these many rounds; then, as the last resort, far around them.
constexpr int kRounds = 8, kWideRounds = 6, kFacesFrom = 4;
constexpr double kFirstReach = 0.25;  // voxels; then 1, 2, 4, ...

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

// Whether the box of a triangle, a voxel larger on each side, has one of the nodes, which are in the order of NodeSet.
bool is_near(const TriangleMesh& mesh, const Triangle& t, const Lattice& lattice, const std::vector<Node>& nodes) {
  Node low{}, high{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const auto [least, most] =
        std::minmax({mesh.vertices[t[0]][axis], mesh.vertices[t[1]][axis], mesh.vertices[t[2]][axis]});
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

class CheckedMerger {
 public:
  CheckedMerger(const SurfaceMesh& surface, const TriangleMesh& input, const NodeSet& inside, double margin,
                double tolerance, bool single_precision, const std::function<bool()>& is_right)
      : surface_(surface),
        input_(input),
        inside_(inside),
        margin_(margin),
        tolerance_(tolerance),
        single_precision_(single_precision),
        is_right_(is_right) {}

  // Points of one plane are as far apart across it as the input's coordinates are rounded, and up to two margins where
  // they are kept off nodes. If faces that are merged as well as that have faults, they are merged where they agree
  // better. None where faults are left even so.
  CheckedMerge merge(bool once) {
    constexpr double kBetter = 0.25;   // margins: less than any point is kept off a node
    constexpr double kManyMore = 1.5;  // times the faces: below, another surface would not be worth its time
    const double unit = margin_ * inside_.lattice().least_spacing();
    std::optional<SurfaceMesh> result;
    if (tolerance_ > kNearPlane * unit) result = merged_within(tolerance_, Effort::kLeast);
    if (!result) result = merged_within(kNearPlane * unit, Effort::kLittle);
    if (!result && !is_wrong_ && !once) result = merged_within(kBetter * unit, Effort::kAll);
    const bool is_costly = !result || static_cast<double>(result->mesh.triangles.size()) > kManyMore * faces_of_all_;
    return {std::move(result), is_costly && cuts_nodes_off_};
  }

 private:
  // Only kLeast goes on without asking whether the surface before is right, which takes longer than merging. kAll goes
  // on with more than a few nodes on the wrong side, as where a plane of the mesh is one of the lattice, to the last
  // resort.
  enum class Effort : std::uint8_t { kLeast, kLittle, kAll };

  // What merging spoils is not merged. `most`: world units.
  std::optional<SurfaceMesh> merged_within(double most, Effort effort) {
    const std::vector<Vec3>& vertices = surface_.mesh.vertices;
    const std::uint64_t few_nodes = std::max<std::size_t>(64, vertices.size() / 256);
    const double unit = margin_ * inside_.lattice().least_spacing();
    kept_.assign(vertices.size(), false);
    at_home_ = kept_;
    PlaneMerger merger(surface_, input_, inside_.lattice(), {most, kNearCorner * unit});
    RepeatedCheck check(inside_, vertices.size());
    std::uint64_t faults_before = 0;
    NodeSet misplaced(inside_.lattice());
    moves_ = PointMoves::kNone;
    const int rounds = effort == Effort::kAll ? kRounds + kWideRounds : kRounds;
    const auto may_go_on = [&] { return effort == Effort::kLeast || is_right(); };
    for (int round = 0; round < rounds; ++round) {
      MergedFaces merged = merger.merge(kept_);
      TriangleMesh compact = used_part(vertices, merged.triangles);
      move_points(merged, unit, compact);
      SurfaceFaults faults = check.faults(merged, compact, misplaced);
      if (!faults.none()) check.remember(merged, compact, faults);
      if (round == 0 && faults.nodes > 0) find_moves(merged, unit, check, compact, faults, misplaced);
      if (round == 0) {
        cuts_nodes_off_ = cuts_nodes_off_ || faults.nodes > 0;
        faces_of_all_ = std::max(faces_of_all_, static_cast<double>(compact.triangles.size()));
      }
      if (faults.none()) return SurfaceMesh{std::move(compact), std::move(merged.sources)};
      if (faults.nodes > few_nodes && effort != Effort::kAll) return std::nullopt;
      const std::uint64_t count = count_of(faults);
      const bool no_better = round > 0 && count >= faults_before;
      if ((no_better || round == kRounds) && !may_go_on()) return std::nullopt;
      faults_before = count;
      // With nothing more kept, the next round would find the same.
      while (!keep({merged, compact, faults, misplaced}, round)) {
        if (++round == rounds || !may_go_on()) return std::nullopt;
      }
    }
    return std::nullopt;
  }

  // Where a plane of the mesh leads through nodes, its faces have them on the right side if they are in that plane
  // exactly, as those between corners of the mesh are. Other points were kept off nodes, or are rounded. Takes the
  // moves with the fewest faults that are undone, and none of others, from now on; sets all to what it is then.
  void find_moves(const MergedFaces& merged, double unit, RepeatedCheck& check, TriangleMesh& mesh,
                  SurfaceFaults& faults, NodeSet& misplaced) {
    const TriangleMesh before = mesh;
    PointMoves best = PointMoves::kNone;
    for (const PointMoves moves : {PointMoves::kToCorners, PointMoves::kIntoLevelPlanes}) {
      if (count_of(faults) == 0) break;
      moves_ = moves;
      TriangleMesh moved = before;
      move_points(merged, unit, moved);
      NodeSet misplaced_then(inside_.lattice());
      SurfaceFaults then = check.faults(merged, moved, misplaced_then);
      const std::uint64_t others = then.edges + then.links + then.degenerate_faces + then.equal_vertices;
      if (others > 0 || count_of(then) >= count_of(faults)) continue;
      check.remember(merged, moved, then);
      mesh = std::move(moved);
      faults = std::move(then);
      misplaced = std::move(misplaced_then);
      best = moves;
    }
    moves_ = best;
  }

  // `mesh`: the faces of `merged`, in their order.
  void move_points(const MergedFaces& merged, double unit, TriangleMesh& mesh) const {
    if (moves_ == PointMoves::kNone) return;
    raycone::move_points(moves_, input_, merged.sources, inside_.lattice(), kNearCorner * unit, mesh);
    for (Vec3& p : mesh.vertices) {
      if (single_precision_) p = rounded_to_float(p);
    }
    for (std::size_t face = 0; face < merged.triangles.size(); ++face) {
      for (std::size_t n = 0; n < 3; ++n) {
        const std::uint32_t v = merged.triangles[face][n];
        if (at_home_[v]) mesh.vertices[mesh.triangles[face][n]] = surface_.mesh.vertices[v];
      }
    }
  }

  // Of those that are undone.
  static std::uint64_t count_of(const SurfaceFaults& faults) { return faults.nodes + faults.intersections.pairs; }

  bool is_right() {
    is_wrong_ = !is_right_();
    return !is_wrong_;
  }

  // What is left of a surface, and what is wrong with that.
  struct Faulty {
    const MergedFaces& merged;
    const TriangleMesh& mesh;  // its faces, in their order
    const SurfaceFaults& faults;
    const NodeSet& misplaced;
  };

  // Returns whether more is kept than before.
  bool keep(const Faulty& found, int round) {
    const bool any_home = keep_at_home(found);
    if (round >= kRounds) return keep_around(found, round - kRounds) || any_home;
    return keep_near(found, round == 0 ? kFirstReach : std::exp2(round - 1)) || any_home;
  }

  // Faces of points that are kept may have faults because these were moved. Returns whether more stay.
  bool keep_at_home(const Faulty& found) {
    const std::vector<bool> touched = vertices_at_faults(found);
    bool is_more = false;
    for (std::size_t v = 0; v < kept_.size(); ++v) {
      if (!touched[v] || !kept_[v] || at_home_[v]) continue;
      at_home_[v] = is_more = true;
    }
    return is_more;
  }

  // Whether more is kept now.
  template <class MayStay>
  bool keep_where(const MayStay& may_stay) {
    bool is_more = false;
    for (std::size_t v = 0; v < kept_.size(); ++v) {
      if (kept_[v] || !may_stay(v)) continue;
      kept_[v] = is_more = true;
    }
    return is_more;
  }

  // Those that faces with faults have: that intersect others, or have no area.
  [[nodiscard]] std::vector<bool> vertices_at_faults(const Faulty& found) const {
    std::vector<bool> touched = faulty_vertices(kept_.size(), found.merged.triangles, found.faults);
    for (std::size_t face = 0; face < found.merged.triangles.size() && found.faults.degenerate_faces > 0; ++face) {
      const Triangle& t = found.mesh.triangles[face];
      if (!collinear(found.mesh.vertices[t[0]], found.mesh.vertices[t[1]], found.mesh.vertices[t[2]])) continue;
      for (const std::uint32_t corner : found.merged.triangles[face]) touched[corner] = true;
    }
    return touched;
  }

  // Large faces are undone near the vertices that they have left, first: `most` voxels from them.
  bool keep_near(const Faulty& found, double most) {
    const std::vector<Vec3>& vertices = surface_.mesh.vertices;
    const std::vector<bool> touched = vertices_at_faults(found);
    const bool has_misplaced = found.faults.nodes > 0;
    return keep_where([&](std::size_t v) {
      const std::uint32_t into = found.merged.into[v];
      const bool undone = touched[into] && voxels_between(vertices[v], vertices[into]) <= most;
      return undone || (has_misplaced && is_beside(vertices[v], found.misplaced));
    });
  }

  // Each time more: all that was pulled into faces with faults and into those around them, in twice as many rings; what
  // is beside nodes on the lines of misplaced ones, four times as far. At last, misplaced nodes are faults of the faces
  // next to them.
  bool keep_around(const Faulty& found, int wide) {
    const std::vector<Vec3>& vertices = surface_.mesh.vertices;
    std::vector<bool> touched = vertices_at_faults(found);
    if (wide >= kFacesFrom) touch_beside(found, touched);
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

  void touch_beside(const Faulty& found, std::vector<bool>& touched) const {
    std::vector<Node> nodes;
    found.misplaced.for_each([&](const Node& node) { nodes.push_back(node); });
    for (const Triangle& t : found.merged.triangles) {
      if (!is_near(surface_.mesh, t, inside_.lattice(), nodes)) continue;
      for (const std::uint32_t corner : t) touched[corner] = true;
    }
  }

  // Along the axis where that is most.
  [[nodiscard]] double voxels_between(const Vec3& p, const Vec3& q) const {
    const Vec3& h = inside_.lattice().spacing;
    return std::max({std::abs(p.x - q.x) / h.x, std::abs(p.y - q.y) / h.y, std::abs(p.z - q.z) / h.z});
  }

  const SurfaceMesh& surface_;
  const TriangleMesh& input_;
  const NodeSet& inside_;
  double margin_, tolerance_;
  bool single_precision_;
  const std::function<bool()>& is_right_;
  bool is_wrong_ = false;      // as far as is known
  std::vector<bool> kept_;     // vertices that are not merged
  std::vector<bool> at_home_;  // nor moved
  PointMoves moves_ = PointMoves::kNone;
  bool cuts_nodes_off_ = false;
  double faces_of_all_ = 0.0;  // how many there are with all merged
};

}  // namespace

CheckedMerge checked_merge(const SurfaceMesh& surface, const TriangleMesh& input, const NodeSet& inside, double margin,
                           double tolerance, bool single_precision, const std::function<bool()>& is_right, bool once) {
  return CheckedMerger(surface, input, inside, margin, tolerance, single_precision, is_right).merge(once);
}

}  // namespace raycone
