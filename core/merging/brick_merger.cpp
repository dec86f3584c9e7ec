#include "core/merging/brick_merger.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <numeric>
#include <span>

#include "core/cells/surface_mesh.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

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

void BrickMerger::merge_all(const SurfaceBricks& bricks) {
  std::vector<std::uint32_t> all(bricks.count());
  std::iota(all.begin(), all.end(), 0U);
  merge_those(bricks, all, nullptr);
}

void BrickMerger::merge_unknown(const SurfaceBricks& bricks, const std::vector<std::uint8_t>& known,
                                std::vector<std::vector<std::uint32_t>>& changed) {
  std::vector<std::uint32_t> unknown;
  for (std::uint32_t brick = 0; brick < bricks.count(); ++brick) {
    if (known[brick] == 0) unknown.push_back(brick);
  }
  merge_those(bricks, unknown, &changed);
}

void BrickMerger::merge_again(const SurfaceBricks& bricks, const std::vector<std::uint32_t>& changed,
                              const std::vector<Triangle>& first) {
  std::vector<std::uint8_t> has_changed(bricks.count(), 0);
  for (const std::uint32_t v : changed) {
    if (bricks.owner[v] < has_changed.size()) has_changed[bricks.owner[v]] = 1;
  }
  for (std::uint32_t v = 0; v < bricks.owner.size(); ++v) {
    if (bricks.owner[v] >= has_changed.size() || has_changed[bricks.owner[v]] == 0) continue;
    state_.into[v] = v;
    state_.settled[v] = 0;
  }
  std::vector<std::uint32_t> again;
  for (std::uint32_t brick = 0; brick < bricks.count(); ++brick) {
    if (has_changed[brick] == 0) continue;
    for (const std::uint32_t face : bricks.faces[brick]) state_.triangles[face] = first[face];
    again.push_back(brick);
  }
  merge_those(bricks, again, nullptr);
}

// `changed`: as merge_unknown() says; or none is asked for.
void BrickMerger::merge_those(const SurfaceBricks& bricks, const std::vector<std::uint32_t>& asked,
                              std::vector<std::vector<std::uint32_t>>* changed) {
  local_.assign(vertices_.size(), SurfaceBricks::kNone);
  parallel_for_each(asked.size(), [&](std::size_t n) {
    const std::uint32_t brick = asked[n];
    merge_one(bricks, brick, changed ? &(*changed)[brick] : nullptr);
  });
}

void BrickMerger::merge_one(const SurfaceBricks& bricks, std::uint32_t brick, std::vector<std::uint32_t>* changed) {
  const std::span<const std::uint32_t> faces = bricks.faces[brick];
  if (faces.size() > PatchMerger::kMostFaces) return;
  const std::vector<std::uint32_t> global = vertices_of(bricks, brick);
  const SurfacePatch patch = patch_of(bricks, brick, global);
  PatchMerger merger(patch, input_, limits_);
  merger.merge();
  for (std::size_t n = 0; n < faces.size(); ++n) {
    Triangle t = merger.triangle(n);
    if (!is_gone(t)) {
      for (std::uint32_t& corner : t) corner = global[corner];
    }
    state_.triangles[faces[n]] = t;
  }
  for (std::uint32_t v = 0; v < global.size(); ++v) {
    if (merger.into()[v] != v) state_.into[global[v]] = global[merger.into()[v]];
    // Bricks that share a vertex may each change this.
    const std::uint8_t settled = merger.is_settled(v) ? 1 : 0;
    if (settled != patch.settled[v])
      std::atomic_ref(state_.settled[global[v]]).store(settled, std::memory_order_relaxed);
    // Of such a vertex another brick may have said so before: what this one does must not depend on that.
    const bool is_shared = bricks.owner[global[v]] != brick;
    if (changed && is_shared && merger.has_changed(v)) changed->push_back(global[v]);
  }
}

// Increasing: choices among equals then depend little on where bricks are. Notes the brick's own ones in `local_`.
std::vector<std::uint32_t> BrickMerger::vertices_of(const SurfaceBricks& bricks, std::uint32_t brick) {
  std::vector<std::uint32_t> global, spare;
  const auto is_own = [&](std::uint32_t v) { return bricks.owner[v] == brick; };
  for (const std::uint32_t face : bricks.faces[brick]) {
    for (const std::uint32_t v : state_.triangles[face]) {
      if (is_own(v) && local_[v] != SurfaceBricks::kNone) continue;
      if (is_own(v)) local_[v] = 0;
      global.push_back(v);
    }
  }
  sort_numbers(global, spare);
  global.erase(std::unique(global.begin(), global.end()), global.end());
  for (std::uint32_t n = 0; n < global.size(); ++n) {
    if (is_own(global[n])) local_[global[n]] = n;
  }
  return global;
}

// `global`: the numbers of its vertices, as vertices_of() has them.
SurfacePatch BrickMerger::patch_of(const SurfaceBricks& bricks, std::uint32_t brick,
                                   const std::vector<std::uint32_t>& global) {
  const std::span<const std::uint32_t> faces = bricks.faces[brick];
  const auto is_own = [&](std::uint32_t v) { return bricks.owner[v] == brick; };
  SurfacePatch patch;
  patch.vertices.reserve(global.size());
  patch.roles.reserve(global.size());
  patch.settled.reserve(global.size());
  for (const std::uint32_t v : global) {
    patch.vertices.push_back(vertices_[v]);
    patch.roles.push_back(!is_own(v) ? VertexRole::kForeign : kept_[v] ? VertexRole::kKept : VertexRole::kFree);
    patch.settled.push_back(std::atomic_ref(state_.settled[v]).load(std::memory_order_relaxed));
  }
  const auto local = [&](std::uint32_t v) {
    if (is_own(v)) return local_[v];
    return static_cast<std::uint32_t>(std::ranges::lower_bound(global, v) - global.begin());
  };
  patch.triangles.reserve(faces.size());
  patch.sources.reserve(faces.size());
  for (const std::uint32_t face : faces) {
    const auto [a, b, c] = state_.triangles[face];
    patch.triangles.push_back({local(a), local(b), local(c)});
    patch.sources.push_back(state_.sources[face]);
  }
  return patch;
}

}  // namespace raycone
