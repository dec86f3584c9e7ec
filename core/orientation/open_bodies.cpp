#include "core/orientation/open_bodies.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/machine/threads.h"
#include "core/orientation/surface_field.h"
#include "core/orientation/surface_samples.h"

namespace raycone {
namespace {

constexpr std::size_t kMostPatches = 1000;

// An outermost closed patch.
struct OutermostPatch {
  std::uint32_t number;
  std::vector<SurfaceSample> samples;  // the largest first
};

std::vector<OutermostPatch> outermost_patches(const std::vector<ClosedPatch>& patches, const ClosedSigns& signs,
                                              const NumberedVertices& vertices) {
  std::vector<OutermostPatch> all;
  for (std::uint32_t i = 0; i < patches.size(); ++i) {
    if (signs.outermost[i] == i) all.push_back({i, {}});
  }
  constexpr std::size_t kSamples = 1024, kLeast = 4, kMost = 64;
  const std::size_t each = std::clamp(kSamples / all.size(), kLeast, kMost);
  parallel_for_each(all.size(), [&](std::size_t n) {
    all[n].samples = sample_surface(patches[all[n].number].surface.faces, vertices, each);
  });
  std::erase_if(all, [](const OutermostPatch& patch) { return patch.samples.empty(); });
  const auto first_face = [&](const OutermostPatch& patch) {
    return first_canonical_face(patches[patch.number].surface.faces, vertices.exact);
  };
  std::ranges::sort(all, [&](const OutermostPatch& a, const OutermostPatch& b) {
    const SurfaceSample &first = a.samples.front(), &other = b.samples.front();
    if (first.weight != other.weight) return first.weight > other.weight;
    if (const auto order = first.face <=> other.face; order != 0) return order < 0;
    return first_face(a) < first_face(b);
  });
  if (all.size() > kMostPatches) all.resize(kMostPatches);
  return all;
}

// For each patch 1 or -1 where the faces wind around all of its samples by more than half a turn, one way; else 0.
std::vector<int> winding_around(const std::vector<OutermostPatch>& patches, const std::vector<Triangle>& faces,
                                const std::vector<Vec3>& vertices) {
  std::vector<int> result(patches.size(), 0);
  if (faces.empty()) return result;
  std::vector<FieldPoint> points;
  for (const OutermostPatch& patch : patches) {
    for (const SurfaceSample& sample : patch.samples) points.push_back({sample.at, 0});
  }
  const std::vector<double> w = SurfaceField(faces, vertices).winding_numbers(points);
  auto it = w.begin();
  for (std::size_t n = 0; n < patches.size(); ++n) {
    const auto end = it + static_cast<std::ptrdiff_t>(patches[n].samples.size());
    const auto [least, most] = std::minmax_element(it, end);
    result[n] = *least > 0.5 ? 1 : *most < -0.5 ? -1 : 0;
    it = end;
  }
  return result;
}

}  // namespace

bool turn_within_open_bodies(const std::vector<ClosedPatch>& patches, const OpenBodies& bodies,
                             const NumberedVertices& vertices, ClosedSigns& signs) {
  if (patches.empty() || bodies.turned.empty()) return false;
  const std::vector<OutermostPatch> outermost = outermost_patches(patches, signs, vertices);
  const std::vector<int> around = winding_around(outermost, bodies.turned, vertices.at);
  if (std::ranges::count(around, 0) == std::ssize(around)) return false;

  std::vector<int> around_as_stored = around;
  for (int& winding : around_as_stored) winding *= bodies.relation;
  if (bodies.relation == 0) around_as_stored = winding_around(outermost, bodies.as_stored, vertices.at);
  std::vector<std::uint8_t> reversed(patches.size(), 0);
  for (std::size_t n = 0; n < outermost.size(); ++n) {
    if (around[n] == 0) continue;
    const std::uint32_t i = outermost[n].number;
    const int as_stored = patches[i].stored * around_as_stored[n];
    const int sign = as_stored != 0 ? as_stored * around[n] : -signs.sign[i] * around[n];
    reversed[i] = sign != signs.sign[i];
  }
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (reversed[signs.outermost[i]]) signs.sign[i] = -signs.sign[i];
  }
  return std::ranges::count(reversed, 1) > 0;
}

}  // namespace raycone
