#include "core/merging/merge_planes.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>

#include "core/data/keep_where.h"
#include "core/machine/threads.h"
#include "core/merging/brick_merger.h"
#include "core/merging/surface_bricks.h"

namespace raycone {

// What the second bricks were made of, and what they became. Faces have the numbers of the surface, or places among
// those that the first bricks left.
struct PlaneMerger::SecondPass {
  SurfaceBricks bricks;
  std::vector<std::uint32_t> faces;     // by their places
  std::vector<Triangle> before, after;  // likewise
  std::vector<std::uint8_t> settled_before, settled_after;
  std::vector<std::uint32_t> into_after;
  std::vector<bool> kept;
  std::vector<std::vector<std::uint32_t>> changed;  // of each brick, as merge_unknown() sets it

  // The place of each face of `now` that was there with the same corners; kNone for others.
  [[nodiscard]] std::vector<std::uint32_t> same_faces(const SecondPass& now) const;
  // A 1 for each brick of `now` that was there, with the same to merge. `same`: its same_faces().
  [[nodiscard]] std::vector<std::uint8_t> same_bricks(const SecondPass& now,
                                                      const std::vector<std::uint32_t>& same) const;
  // Sets what the `known` bricks of `now` have become.
  void repeat(SecondPass& now, const std::vector<std::uint8_t>& known, const std::vector<std::uint32_t>& same,
              MergedFaces& merged, std::vector<std::uint8_t>& settled) const;
};

namespace {

constexpr std::uint32_t kNone = SurfaceBricks::kNone;

void drop_gone(MergedFaces& faces) {
  const auto is_there = [&](std::size_t face) { return !is_gone(faces.triangles[face]); };
  keep_where(is_there, faces.triangles, faces.sources, faces.faces);
}

}  // namespace

// Both lists increase.
std::vector<std::uint32_t> PlaneMerger::SecondPass::same_faces(const SecondPass& now) const {
  std::vector<std::uint32_t> same(now.faces.size(), kNone);
  std::uint32_t place = 0;
  for (std::size_t n = 0; n < same.size(); ++n) {
    while (place < faces.size() && faces[place] < now.faces[n]) ++place;
    if (place < faces.size() && faces[place] == now.faces[n] && before[place] == now.before[n]) same[n] = place;
  }
  return same;
}

// A brick is another one if a face came, or went, or one of its vertices is kept, settled or owned as it was not.
std::vector<std::uint8_t> PlaneMerger::SecondPass::same_bricks(const SecondPass& now,
                                                               const std::vector<std::uint32_t>& same) const {
  const std::vector<std::uint32_t> then = bricks.by_place();
  const auto is_same_vertex = [&](std::uint32_t v) {
    return kept[v] == now.kept[v] && settled_before[v] == now.settled_before[v] &&
           bricks.place_of_owner(v) == now.bricks.place_of_owner(v);
  };
  std::vector<std::uint8_t> result(now.bricks.count(), 0);
  parallel_for_each(result.size(), [&](std::size_t brick) {
    const std::span<const std::uint32_t> of_brick = now.bricks.faces[brick];
    const std::uint32_t place = now.bricks.places[brick];
    const bool was_there = place < then.size() && then[place] != kNone;
    const bool is_same = was_there && bricks.faces[then[place]].size() == of_brick.size() &&
                         std::ranges::all_of(of_brick, [&](std::uint32_t face) {
                           return same[face] != kNone && std::ranges::all_of(now.before[face], is_same_vertex);
                         });
    result[brick] = is_same ? 1 : 0;
  });
  return result;
}

void PlaneMerger::SecondPass::repeat(SecondPass& now, const std::vector<std::uint8_t>& known,
                                     const std::vector<std::uint32_t>& same, MergedFaces& merged,
                                     std::vector<std::uint8_t>& settled) const {
  const std::vector<std::uint32_t> then = bricks.by_place();
  for (std::size_t brick = 0; brick < known.size(); ++brick) {
    if (known[brick] == 0) continue;
    for (const std::uint32_t face : now.bricks.faces[brick]) merged.triangles[face] = after[same[face]];
    now.changed[brick] = changed[then[now.bricks.places[brick]]];
    for (const std::uint32_t v : now.changed[brick]) settled[v] = 0;
  }
  for (std::size_t v = 0; v < now.bricks.owner.size(); ++v) {
    if (now.bricks.owner[v] >= known.size() || known[now.bricks.owner[v]] == 0) continue;
    merged.into[v] = into_after[v];
    settled[v] = settled_after[v];
  }
}

PlaneMerger::PlaneMerger(const SurfaceMesh& surface, const TriangleMesh& input, const Lattice& lattice,
                         const MergeLimits& limits)
    : surface_(surface), input_(input), lattice_(lattice), limits_(limits) {}

// A brick's faces fit into the cache, and threads share bricks. What is at their borders is merged in other bricks,
// shifted by half of one; then what is left, as a whole. Nearly all time goes to the first bricks.
MergedFaces PlaneMerger::merge(const std::vector<bool>& kept) {
  merge_first_bricks(kept);
  MergedFaces merged{{}, {}, into_, {}};
  for (std::size_t face = 0; face < triangles_.size(); ++face) {
    if (is_gone(triangles_[face])) continue;
    merged.triangles.push_back(triangles_[face]);
    merged.sources.push_back(surface_.sources[face]);
    merged.faces.push_back(static_cast<std::uint32_t>(face));
  }
  std::vector<std::uint8_t> settled = settled_;
  BrickMerger merger(surface_.mesh.vertices, input_, kept, limits_,
                     {merged.triangles, merged.sources, merged.into, settled});
  merge_second_bricks(kept, merger, merged, settled);
  drop_gone(merged);
  merger.merge_all(one_brick_of(surface_.mesh.vertices.size(), merged.triangles));
  drop_gone(merged);
  for (std::uint32_t& target : merged.into) {
    while (merged.into[target] != target) target = merged.into[target];
  }
  return merged;
}

// The second bricks become what they became in the last call, where the first ones left them the same faces.
void PlaneMerger::merge_second_bricks(const std::vector<bool>& kept, BrickMerger& merger, MergedFaces& merged,
                                      std::vector<std::uint8_t>& settled) {
  constexpr double kHalf = 0.5;
  auto now = std::make_shared<SecondPass>();
  now->bricks = bricks_of(surface_.mesh.vertices, merged.triangles, lattice_, kHalf);
  now->faces = merged.faces;
  now->before = merged.triangles;
  now->settled_before = settled;
  now->kept = kept;
  now->changed.resize(now->bricks.count());
  std::vector<std::uint8_t> known(now->bricks.count(), 0);
  if (second_) {
    const std::vector<std::uint32_t> same = second_->same_faces(*now);
    known = second_->same_bricks(*now, same);
    second_->repeat(*now, known, same, merged, settled);
  }
  merger.merge_unknown(now->bricks, known, now->changed);
  now->after = merged.triangles;
  now->into_after = merged.into;
  now->settled_after = settled;
  second_ = std::move(now);
}

void PlaneMerger::merge_first_bricks(const std::vector<bool>& kept) {
  const std::vector<Vec3>& vertices = surface_.mesh.vertices;
  BrickMerger merger(vertices, input_, kept, limits_, {triangles_, surface_.sources, into_, settled_});
  if (into_.empty()) {
    triangles_ = surface_.mesh.triangles;
    settled_.assign(vertices.size(), 0);
    into_.resize(vertices.size());
    std::iota(into_.begin(), into_.end(), 0U);
    bricks_ = std::make_shared<const SurfaceBricks>(bricks_of(vertices, triangles_, lattice_, 0.0));
    merger.merge_all(*bricks_);
  } else {
    std::vector<std::uint32_t> changed;
    for (std::uint32_t v = 0; v < kept.size(); ++v) {
      if (kept[v] != kept_[v]) changed.push_back(v);
    }
    merger.merge_again(*bricks_, changed, surface_.mesh.triangles);
  }
  kept_ = kept;
}

}  // namespace raycone
