#include "core/orientation/closed_patches.h"

#include <numeric>

#include "core/exact/volume_sign.h"
#include "core/machine/threads.h"
#include "core/orientation/canonical_face.h"
#include "core/orientation/nesting.h"
#include "core/orientation/nesting_tree.h"

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

ClosedSigns turn_closed_patches(const std::vector<ClosedPatch>& patches, const std::vector<Vec3>& vertices) {
  const std::vector<int> outward = outward_signs(patches, vertices);
  ClosedSigns result{outward, std::vector<std::uint32_t>(patches.size())};
  std::iota(result.outermost.begin(), result.outermost.end(), 0U);
  if (patches.size() < 2) return result;
  const std::vector<const ClosedSurface*> surfaces = surfaces_of(patches);
  const NestingTree tree = nesting_tree(surfaces_around(surfaces, vertices), surfaces, vertices);
  std::vector<int>& sign = result.sign;
  for (const std::uint32_t i : tree.order) {
    const std::uint32_t parent = tree.parent[i];
    if (parent == i) continue;
    const int as_stored = patches[i].stored * patches[parent].stored;
    sign[i] = as_stored != 0 ? as_stored * sign[parent] : -outward[i] * outward[parent] * sign[parent];
    result.outermost[i] = result.outermost[parent];
  }
  return result;
}

}  // namespace raycone
