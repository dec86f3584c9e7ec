#include "core/orientation/closed_patches.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "core/exact/volume_sign.h"
#include "core/machine/threads.h"
#include "core/orientation/canonical_face.h"

namespace raycone {
namespace {

int outward_sign(const ClosedSurface& surface, const std::vector<Vec3>& vertices) {
  if (const int sign = volume_sign(surface.faces, vertices); sign != 0) return sign;
  return first_canonical_face(surface.faces, vertices).sign;
}

std::vector<int> outward_signs(const std::vector<ClosedPatch>& patches, const std::vector<Vec3>& vertices) {
  std::vector<int> signs(patches.size());
  parallel_for_each(patches.size(), [&](std::size_t i) { signs[i] = outward_sign(patches[i].surface, vertices); });
  return signs;
}

std::vector<const ClosedSurface*> surfaces_of(const std::vector<ClosedPatch>& patches) {
  std::vector<const ClosedSurface*> surfaces;
  for (const ClosedPatch& patch : patches) surfaces.push_back(&patch.surface);
  return surfaces;
}

}  // namespace

ClosedTurns turn_closed_patches(const std::vector<ClosedPatch>& patches, const std::vector<Vec3>& vertices) {
  const std::vector<int> outward = outward_signs(patches, vertices);
  ClosedTurns result{outward, std::vector<std::uint32_t>(patches.size())};
  std::iota(result.outermost.begin(), result.outermost.end(), 0U);
  if (patches.size() < 2) return result;
  const std::vector<std::vector<std::uint32_t>> around = surfaces_around(surfaces_of(patches), vertices);

  std::vector<std::uint32_t> from_outside(patches.size());
  std::iota(from_outside.begin(), from_outside.end(), 0U);
  std::stable_sort(from_outside.begin(), from_outside.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return around[a].size() < around[b].size(); });
  std::vector<std::optional<CanonicalFace>> first(patches.size());  // of those that were asked for
  const auto first_face = [&](std::uint32_t i) {
    if (!first[i]) first[i] = first_canonical_face(patches[i].surface.faces, vertices);
    return *first[i];
  };
  const auto is_farther_out = [&](std::uint32_t a, std::uint32_t b) {
    if (around[a].size() != around[b].size()) return around[a].size() < around[b].size();
    return first_face(b) < first_face(a);
  };
  std::vector<int>& turn = result.turn;
  for (const std::uint32_t i : from_outside) {
    // Surfaces that pass through themselves or touch may each be around the other: neither is the parent then.
    std::vector<std::uint32_t> outer = around[i];
    std::erase_if(outer, [&](std::uint32_t j) { return around[j].size() >= around[i].size(); });
    if (outer.empty()) continue;
    const std::uint32_t parent = *std::max_element(outer.begin(), outer.end(), is_farther_out);
    const int as_stored = patches[i].stored * patches[parent].stored;
    turn[i] = as_stored != 0 ? as_stored * turn[parent] : -outward[i] * outward[parent] * turn[parent];
    result.outermost[i] = result.outermost[parent];
  }
  return result;
}

}  // namespace raycone
