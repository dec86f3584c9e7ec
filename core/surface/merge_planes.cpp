#include "core/surface/merge_planes.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>

#include "core/machine/first_touch.h"
#include "core/machine/sorted_by_key.h"
#include "core/machine/threads.h"
#include "core/surface/surface_edit.h"

namespace raycone {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFF, kUnmet = 0xFFFFFFFE;
constexpr std::size_t kFacesPerTask = 4096;

// Sorts many numbers digit by digit, the lowest first, which is sooner than by comparisons; few by comparisons.
void sort_numbers(std::vector<std::uint32_t>& numbers, std::vector<std::uint32_t>& spare) {
  constexpr unsigned kDigit = 11;
  constexpr std::size_t kWorthIt = 1024;
  if (numbers.size() < kWorthIt) {
    std::ranges::sort(numbers);
    return;
  }
  spare.resize(numbers.size());
  for (unsigned shift = 0; shift < 32; shift += kDigit) {
    std::array<std::uint32_t, (1U << kDigit) + 1> next{};
    for (const std::uint32_t n : numbers) ++next[(n >> shift & ((1U << kDigit) - 1)) + 1];
    for (std::size_t digit = 1; digit < next.size(); ++digit) next[digit] += next[digit - 1];
    for (const std::uint32_t n : numbers) spare[next[n >> shift & ((1U << kDigit) - 1)]++] = n;
    numbers.swap(spare);
  }
}

}  // namespace

// The numbers of faces by brick, and of each vertex the brick that has all of its faces.
struct PlaneMerger::Bricks {
  SortedByKey<std::uint32_t> faces;
  std::vector<std::uint32_t> owner;   // kNone where several bricks have faces there; kUnmet where none has
  std::vector<std::uint32_t> places;  // of each brick among all of the lattice's

  [[nodiscard]] std::size_t count() const { return faces.keys(); }
  [[nodiscard]] std::uint32_t place_of_owner(std::uint32_t vertex) const {
    return owner[vertex] < count() ? places[owner[vertex]] : owner[vertex];
  }
};

// What the second bricks were made of, and what they became. Faces have the numbers of the surface, or places among
// those that the first bricks left.
struct PlaneMerger::SecondPass {
  Bricks bricks;
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
  // Of such bricks, sets what these became.
  void repeat(SecondPass& now, const std::vector<std::uint8_t>& known, const std::vector<std::uint32_t>& same,
              MergedFaces& merged, std::vector<std::uint8_t>& settled) const;
};

// What faces and vertices are so far.
struct PlaneMerger::Work {
  std::vector<Triangle>& triangles;  // those that are gone have three equal corners
  const std::vector<std::int32_t>& sources;
  std::vector<std::uint32_t>& into;
  std::vector<std::uint8_t>& settled;  // of each vertex, what PatchMerger::is_settled() said
};

class BrickMerger {
 public:
  BrickMerger(const std::vector<Vec3>& vertices, const TriangleMesh& input, const Lattice& lattice,
              const std::vector<bool>& kept, const MergeLimits& limits, PlaneMerger::Work work)
      : vertices_(vertices), input_(input), lattice_(lattice), kept_(kept), limits_(limits), work_(work) {}

  using Bricks = PlaneMerger::Bricks;

  // A face is in the brick of its first corner. Bricks are in the order of their first faces.
  [[nodiscard]] Bricks bricks(double shift) const {
    auto brick_of = sized_on_all_threads<std::uint32_t>(work_.triangles.size());
    parallel_for_each(brick_of.size(), kFacesPerTask,
                      [&](std::size_t face) { brick_of[face] = brick_at(vertices_[work_.triangles[face][0]], shift); });
    std::vector<std::uint32_t> numbers(all_bricks(), kNone), places;
    for (std::uint32_t& brick : brick_of) {
      std::uint32_t& number = numbers[brick];
      if (number == kNone) {
        number = static_cast<std::uint32_t>(places.size());
        places.push_back(brick);
      }
      brick = number;
    }
    Bricks result = sorted(brick_of, places.size());
    result.places = std::move(places);
    return result;
  }

  // How many the lattice has.
  [[nodiscard]] std::size_t all_bricks() const {
    return static_cast<std::size_t>(bricks_along(0) * bricks_along(1) * bricks_along(2));
  }

  void merge_all(const Bricks& bricks) {
    local_.assign(vertices_.size(), kNone);
    parallel_for(bricks.count(), 1, [&](std::size_t begin, std::size_t end) {
      for (auto brick = static_cast<std::uint32_t>(begin); brick < end; ++brick) merge_one(bricks, brick);
    });
  }
  // But for those that are `known`. Sets `changed` of each of the others to the vertices with faces in other bricks,
  // too, that have other faces in this one now.
  void merge_unknown(const Bricks& bricks, const std::vector<std::uint8_t>& known,
                     std::vector<std::vector<std::uint32_t>>& changed) {
    local_.assign(vertices_.size(), kNone);
    parallel_for(bricks.count(), 1, [&](std::size_t begin, std::size_t end) {
      for (auto brick = static_cast<std::uint32_t>(begin); brick < end; ++brick) {
        if (known[brick] == 0) merge_one(bricks, brick, &changed[brick]);
      }
    });
  }
  void merge_whole() { merge_all(sorted(std::vector<std::uint32_t>(work_.triangles.size(), 0), 1)); }

  // Those bricks alone that have a vertex of `changed`, from `first` on, as merge_all() would: a vertex that is kept or
  // is no longer so matters to the one brick that has all of its faces.
  void merge_again(const Bricks& all, const std::vector<std::uint32_t>& changed, const std::vector<Triangle>& first) {
    std::vector<std::uint8_t> again(all.count(), 0);
    for (const std::uint32_t v : changed) {
      if (all.owner[v] < again.size()) again[all.owner[v]] = 1;
    }
    for (std::uint32_t v = 0; v < all.owner.size(); ++v) {
      if (all.owner[v] >= again.size() || again[all.owner[v]] == 0) continue;
      work_.into[v] = v;
      work_.settled[v] = 0;
    }
    for (std::size_t brick = 0; brick < again.size(); ++brick) {
      if (again[brick] == 0) continue;
      for (const std::uint32_t face : all.faces[brick]) work_.triangles[face] = first[face];
    }
    local_.assign(vertices_.size(), kNone);
    parallel_for(again.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (auto brick = static_cast<std::uint32_t>(begin); brick < end; ++brick) {
        if (again[brick] != 0) merge_one(all, brick);
      }
    });
  }

 private:
  static constexpr double kSide = 32.0;  // voxels

  // Bricks along an axis, whether they are shifted or not.
  [[nodiscard]] std::int64_t bricks_along(int axis) const {
    return static_cast<std::int64_t>(static_cast<double>(lattice_.counts[static_cast<std::size_t>(axis)]) / kSide) + 2;
  }

  // The place of the brick of a point in all of the lattice's, x fastest.
  [[nodiscard]] std::uint32_t brick_at(const Vec3& p, double shift) const {
    std::int64_t place = 0;
    for (int axis = 2; axis >= 0; --axis) {
      const double at = lattice_.steps_from_first(axis, p[axis]);
      const auto brick = static_cast<std::int64_t>(std::floor(at / kSide + shift));
      place = place * bricks_along(axis) + std::clamp<std::int64_t>(brick, 0, bricks_along(axis) - 1);
    }
    return static_cast<std::uint32_t>(place);
  }

  [[nodiscard]] Bricks sorted(const std::vector<std::uint32_t>& brick_of, std::size_t count) const {
    Bricks result{{count,
                   [&](const auto& emit) {
                     for (std::uint32_t face = 0; face < brick_of.size(); ++face) emit(brick_of[face], face);
                   }},
                  std::vector<std::uint32_t>(vertices_.size(), kUnmet),
                  {}};
    find_owners(brick_of, result.owner);
    return result;
  }

  // Whoever comes second from another brick finds one there; none takes its place for good.
  void find_owners(const std::vector<std::uint32_t>& brick_of, std::vector<std::uint32_t>& owner) const {
    parallel_for_each(brick_of.size(), kFacesPerTask, [&](std::size_t face) {
      for (const std::uint32_t corner : work_.triangles[face]) {
        const std::atomic_ref of_corner(owner[corner]);
        std::uint32_t known = of_corner.load(std::memory_order_relaxed);
        if (known == kUnmet) of_corner.compare_exchange_strong(known, brick_of[face], std::memory_order_relaxed);
        const bool is_own = known == kUnmet || known == brick_of[face];
        if (!is_own) of_corner.store(kNone, std::memory_order_relaxed);
      }
    });
  }

  // Bricks change their own faces only, and where their own vertices are pulled.
  void merge_one(const Bricks& bricks, std::uint32_t brick, std::vector<std::uint32_t>* changed = nullptr) {
    const std::span<const std::uint32_t> faces = bricks.faces[brick];
    if (faces.size() > PatchMerger::kMostFaces) return;
    std::vector<std::uint32_t> global;
    const SurfacePatch patch = patch_of(faces, bricks.owner, brick, global);
    PatchMerger merger(patch, input_, limits_);
    merger.merge();
    for (std::size_t n = 0; n < faces.size(); ++n) {
      Triangle t = merger.triangle(n);
      if (!is_gone(t)) {
        for (std::uint32_t& corner : t) corner = global[corner];
      }
      work_.triangles[faces[n]] = t;
    }
    for (std::uint32_t v = 0; v < global.size(); ++v) {
      if (merger.into()[v] != v) work_.into[global[v]] = global[merger.into()[v]];
      note_settled(global[v], patch.settled[v] != 0, merger.is_settled(v));
      // Of such a vertex another brick may have said so before: what this one does must not depend on that.
      const bool is_shared = bricks.owner[global[v]] != brick;
      if (changed && is_shared && merger.has_changed(v)) changed->push_back(global[v]);
    }
  }

  // Of a vertex with faces in several bricks, each of them may say that these have changed.
  void note_settled(std::uint32_t vertex, bool before, bool is) {
    if (is != before) std::atomic_ref(work_.settled[vertex]).store(is ? 1 : 0, std::memory_order_relaxed);
  }

  // `global`: the numbers of its vertices, increasing: choices among equals then depend little on where bricks are.
  SurfacePatch patch_of(std::span<const std::uint32_t> faces, const std::vector<std::uint32_t>& owner,
                        std::uint32_t brick, std::vector<std::uint32_t>& global) {
    const auto is_own = [&](std::uint32_t v) { return owner[v] == brick; };
    for (const std::uint32_t face : faces) {
      for (const std::uint32_t v : work_.triangles[face]) {
        if (is_own(v) && local_[v] != kNone) continue;
        if (is_own(v)) local_[v] = 0;
        global.push_back(v);
      }
    }
    std::vector<std::uint32_t> spare;
    sort_numbers(global, spare);
    global.erase(std::unique(global.begin(), global.end()), global.end());

    SurfacePatch patch;
    patch.vertices.reserve(global.size());
    patch.roles.reserve(global.size());
    patch.settled.reserve(global.size());
    for (std::uint32_t n = 0; n < global.size(); ++n) {
      const std::uint32_t v = global[n];
      if (is_own(v)) local_[v] = n;
      patch.vertices.push_back(vertices_[v]);
      patch.roles.push_back(!is_own(v) ? VertexRole::kForeign : kept_[v] ? VertexRole::kKept : VertexRole::kFree);
      patch.settled.push_back(std::atomic_ref(work_.settled[v]).load(std::memory_order_relaxed));
    }
    const auto local = [&](std::uint32_t v) {
      if (is_own(v)) return local_[v];
      return static_cast<std::uint32_t>(std::ranges::lower_bound(global, v) - global.begin());
    };
    patch.triangles.reserve(faces.size());
    patch.sources.reserve(faces.size());
    for (const std::uint32_t face : faces) {
      const auto [a, b, c] = work_.triangles[face];
      patch.triangles.push_back({local(a), local(b), local(c)});
      patch.sources.push_back(work_.sources[face]);
    }
    return patch;
  }

  const std::vector<Vec3>& vertices_;
  const TriangleMesh& input_;
  const Lattice& lattice_;
  const std::vector<bool>& kept_;
  MergeLimits limits_;
  PlaneMerger::Work work_;
  std::vector<std::uint32_t> local_;  // numbers of vertices in the bricks that have all of their faces
};

namespace {

void drop_gone(MergedFaces& faces) {
  std::size_t left = 0;
  for (std::size_t face = 0; face < faces.triangles.size(); ++face) {
    const Triangle t = faces.triangles[face];
    if (is_gone(t)) continue;
    faces.sources[left] = faces.sources[face];
    faces.faces[left] = faces.faces[face];
    faces.triangles[left++] = t;
  }
  faces.triangles.resize(left);
  faces.sources.resize(left);
  faces.faces.resize(left);
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
  std::vector<std::uint32_t> size_then(bricks.places.empty() ? 0 : 1 + std::ranges::max(bricks.places), 0);
  for (std::size_t brick = 0; brick < bricks.count(); ++brick)
    size_then[bricks.places[brick]] = static_cast<std::uint32_t>(bricks.faces[brick].size());
  const auto is_same_vertex = [&](std::uint32_t v) {
    return kept[v] == now.kept[v] && settled_before[v] == now.settled_before[v] &&
           bricks.place_of_owner(v) == now.bricks.place_of_owner(v);
  };
  std::vector<std::uint8_t> result(now.bricks.count(), 0);
  parallel_for_each(result.size(), [&](std::size_t brick) {
    const std::span<const std::uint32_t> of_brick = now.bricks.faces[brick];
    const std::uint32_t place = now.bricks.places[brick];
    const bool is_same = place < size_then.size() && size_then[place] == of_brick.size() &&
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
  std::vector<std::uint32_t> brick_then(bricks.places.empty() ? 0 : 1 + std::ranges::max(bricks.places), kNone);
  for (std::uint32_t brick = 0; brick < bricks.count(); ++brick) brick_then[bricks.places[brick]] = brick;
  for (std::size_t brick = 0; brick < known.size(); ++brick) {
    if (known[brick] == 0) continue;
    for (const std::uint32_t face : now.bricks.faces[brick]) merged.triangles[face] = after[same[face]];
    now.changed[brick] = changed[brick_then[now.bricks.places[brick]]];
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
  BrickMerger merger(surface_.mesh.vertices, input_, lattice_, kept, limits_,
                     {merged.triangles, merged.sources, merged.into, settled});
  merge_second_bricks(kept, merger, merged, settled);
  drop_gone(merged);
  merger.merge_whole();
  drop_gone(merged);
  for (std::uint32_t& target : merged.into) {
    while (merged.into[target] != target) target = merged.into[target];
  }
  return merged;
}

// Where the first bricks left the same as in the last call, the second ones make the same of it.
void PlaneMerger::merge_second_bricks(const std::vector<bool>& kept, BrickMerger& merger, MergedFaces& merged,
                                      std::vector<std::uint8_t>& settled) {
  constexpr double kHalf = 0.5;
  auto now = std::make_shared<SecondPass>();
  now->bricks = merger.bricks(kHalf);
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
  BrickMerger merger(vertices, input_, lattice_, kept, limits_, {triangles_, surface_.sources, into_, settled_});
  if (into_.empty()) {
    triangles_ = surface_.mesh.triangles;
    settled_.assign(vertices.size(), 0);
    into_.resize(vertices.size());
    std::iota(into_.begin(), into_.end(), 0U);
    bricks_ = std::make_shared<const Bricks>(merger.bricks(0.0));
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

MergedFaces merge_planes(const SurfaceMesh& surface, const TriangleMesh& input, const Lattice& lattice,
                         const std::vector<bool>& kept, const MergeLimits& limits) {
  return PlaneMerger(surface, input, lattice, limits).merge(kept);
}

}  // namespace raycone
