#include "core/merging/checked_merge.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/cells/surface_mesh.h"
#include "core/certificate/certificate.h"
#include "core/data/coordinate_precision.h"
#include "core/merging/kept_vertices.h"
#include "core/merging/left_behind.h"
#include "core/merging/merge_planes.h"
#include "core/merging/mesh_corners.h"
#include "core/merging/repeated_check.h"
#include "core/mesh/used_part.h"

namespace raycone {
namespace {

class CheckedMerger {
 public:
  CheckedMerger(const SurfaceMesh& surface, const TriangleMesh& input, const NodeSet& inside,
                const MergeOptions& options, const std::function<bool()>& is_right)
      : surface_(surface),
        input_(input),
        inside_(inside),
        options_(options),
        unit_(options.margin * inside.lattice().least_spacing()),
        is_right_(is_right) {}

  // Points of one plane are as far apart across it as the input's coordinates are rounded, and up to two margins where
  // they are kept off nodes. If faces that are merged as well as that have faults, they are merged where they agree
  // better. None where faults are left even so.
  CheckedMerge merge() {
    constexpr double kBetter = 0.25;   // margins: less than any point is kept off a node
    constexpr double kManyMore = 1.5;  // times the faces: below, another surface would not be worth its time
    std::optional<SurfaceMesh> result;
    if (options_.tolerance > kNearPlane * unit_) result = merged_within(options_.tolerance, Effort::kLeast);
    if (!result) result = merged_within(kNearPlane * unit_, Effort::kLittle);
    if (!result && !is_wrong_ && !options_.once) result = merged_within(kBetter * unit_, Effort::kAll);
    const bool is_costly = !result || static_cast<double>(result->mesh.triangles.size()) > kManyMore * faces_of_all_;
    return {std::move(result), is_costly && cuts_nodes_off_};
  }

 private:
  // Only kLeast goes on without asking whether the surface before is right, which takes longer than merging. kAll goes
  // on with more than a few nodes on the wrong side, as where a plane of the mesh is one of the lattice, to the last
  // resort.
  enum class Effort : std::uint8_t { kLeast, kLittle, kAll };

  // One way to merge: within `most`, world units.
  struct Attempt {
    double most;
    PlaneMerger merger;
    RepeatedCheck check;
    KeptVertices kept;
    NodeSet misplaced;  // after the last round
    PointMoves moves = PointMoves::kNone;
    int drifts = 0;  // how often something was left behind
  };

  // What a round has made of the surface, and what is wrong with that.
  struct Outcome {
    MergedFaces merged;
    TriangleMesh mesh;  // its faces, in their order
    SurfaceFaults faults;
  };

  // What merging spoils is not merged: each round keeps more of the surface as it is.
  std::optional<SurfaceMesh> merged_within(double most, Effort effort) {
    const std::size_t vertices = surface_.mesh.vertices.size();
    Attempt attempt{most, PlaneMerger(surface_, input_, inside_.lattice(), {most, kNearCorner * unit_}),
                    RepeatedCheck(inside_, vertices), KeptVertices(surface_), NodeSet(inside_.lattice())};
    if (!is_right_) attempt.check.remember_whole(surface_);
    const std::uint64_t few_nodes = std::max<std::size_t>(64, vertices / 256);
    const int rounds = KeptVertices::kRounds + (effort == Effort::kAll ? KeptVertices::kWideRounds : 0);
    const auto may_go_on = [&] { return effort == Effort::kLeast || is_right(); };
    std::uint64_t faults_before = 0;
    for (int round = 0; round < rounds; ++round) {
      std::optional<Outcome> found = merged_without_drift(attempt, round);
      if (!found) return std::nullopt;
      const SurfaceFaults& faults = found->faults;
      if (faults.none()) return SurfaceMesh{std::move(found->mesh), std::move(found->merged.sources)};
      if (faults.nodes > few_nodes && effort != Effort::kAll) return std::nullopt;
      const std::uint64_t count = count_of(faults);
      const bool no_better = round > 0 && count >= faults_before;
      if ((no_better || round == KeptVertices::kRounds) && !may_go_on()) return std::nullopt;
      faults_before = count;
      // With nothing more kept, the next round would find the same.
      while (!attempt.kept.keep_more({found->merged, found->mesh, faults, attempt.misplaced}, round)) {
        if (++round == rounds || !may_go_on()) return std::nullopt;
      }
    }
    return std::nullopt;
  }

  // Where nothing is at fault, but some of the surface was left behind, that is kept, too, and all is merged again.
  // Nothing where this does not come to an end.
  std::optional<Outcome> merged_without_drift(Attempt& attempt, int round) {
    constexpr int kMostDrifts = 32;  // a bend of 62 tolerances takes one
    for (; attempt.drifts <= kMostDrifts; ++attempt.drifts) {
      Outcome found = merged_once(attempt);
      if (round == 0) note_all_merged(attempt, found);
      if (!found.faults.none()) return found;
      const std::vector<std::uint32_t> behind =
          left_behind(surface_, found.merged, found.mesh, most_apart(attempt.most, found.mesh));
      if (behind.empty()) return found;
      attempt.kept.keep(behind);
    }
    return std::nullopt;
  }

  Outcome merged_once(Attempt& attempt) const {
    Outcome found;
    found.merged = attempt.merger.merge(attempt.kept.kept());
    found.mesh = used_part(surface_.mesh.vertices, found.merged.triangles);
    apply_moves(attempt, found.merged, found.mesh);
    found.faults = attempt.check.faults(found.merged, found.mesh, attempt.misplaced);
    if (!found.faults.none()) attempt.check.remember(found.merged, found.mesh, found.faults);
    return found;
  }

  // `found`: the outcome of a first round. Its faults may become fewer.
  void note_all_merged(Attempt& attempt, Outcome& found) {
    if (found.faults.nodes > 0) find_moves(attempt, found);
    cuts_nodes_off_ = cuts_nodes_off_ || found.faults.nodes > 0;
    faces_of_all_ = std::max(faces_of_all_, static_cast<double>(found.mesh.triangles.size()));
  }

  // Where a plane of the mesh leads through nodes, its faces have them on the right side if they are in that plane
  // exactly, as those between corners of the mesh are. Other points were kept off nodes, or are rounded. Takes the
  // moves with the fewest faults that are undone, and none of others, from now on; sets `found` to what it is then.
  void find_moves(Attempt& attempt, Outcome& found) const {
    const TriangleMesh before = found.mesh;
    PointMoves best = PointMoves::kNone;
    for (const PointMoves moves : {PointMoves::kToCorners, PointMoves::kIntoLevelPlanes}) {
      if (count_of(found.faults) == 0) break;
      attempt.moves = moves;
      TriangleMesh moved = before;
      apply_moves(attempt, found.merged, moved);
      NodeSet misplaced(inside_.lattice());
      SurfaceFaults faults = attempt.check.faults(found.merged, moved, misplaced);
      const std::uint64_t others = faults.edges + faults.links + faults.degenerate_faces + faults.equal_vertices;
      if (others > 0 || count_of(faults) >= count_of(found.faults)) continue;
      attempt.check.remember(found.merged, moved, faults);
      found.mesh = std::move(moved);
      found.faults = std::move(faults);
      attempt.misplaced = std::move(misplaced);
      best = moves;
    }
    attempt.moves = best;
  }

  // `mesh`: the faces of `merged`, in their order.
  void apply_moves(const Attempt& attempt, const MergedFaces& merged, TriangleMesh& mesh) const {
    if (attempt.moves == PointMoves::kNone) return;
    move_points(attempt.moves, input_, merged.sources, inside_.lattice(), kNearCorner * unit_, mesh);
    round_to(options_.precision, mesh.vertices);
    for (std::size_t face = 0; face < merged.triangles.size(); ++face) {
      for (std::size_t n = 0; n < 3; ++n) {
        const std::uint32_t v = merged.triangles[face][n];
        if (attempt.kept.at_home()[v]) mesh.vertices[mesh.triangles[face][n]] = surface_.mesh.vertices[v];
      }
    }
  }

  // Points at a node become one; what vanished may be off a plane on one side, what is left on the other.
  [[nodiscard]] double most_apart(double most, const TriangleMesh& mesh) const {
    constexpr double kRounding = 0x1p-47;  // of distances: 2^-51 of coordinates is what they are off by at most
    return kNearCorner * unit_ + 2 * most + kRounding * largest_coordinate(bounding_box(mesh));
  }

  // Of those that are undone.
  static std::uint64_t count_of(const SurfaceFaults& faults) { return faults.nodes + faults.intersections.pairs; }

  bool is_right() {
    is_wrong_ = is_right_ && !is_right_();
    return !is_wrong_;
  }

  const SurfaceMesh& surface_;
  const TriangleMesh& input_;
  const NodeSet& inside_;
  MergeOptions options_;
  double unit_;  // the margin, world units
  const std::function<bool()>& is_right_;
  bool is_wrong_ = false;  // as far as is known
  bool cuts_nodes_off_ = false;
  double faces_of_all_ = 0.0;  // how many there are with all merged
};

}  // namespace

CheckedMerge checked_merge(const SurfaceMesh& surface, const TriangleMesh& input, const NodeSet& inside,
                           const MergeOptions& options, const std::function<bool()>& is_right) {
  return CheckedMerger(surface, input, inside, options, is_right).merge();
}

}  // namespace raycone
