#include "core/sharpening/face_placement.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/cells/source_plane.h"
#include "core/cells/unit_normal.h"
#include "core/machine/first_touch.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

Placed placed(const std::vector<Vec3>& vertices, const Triangle& t, const SourcePlane& plane, double off) {
  constexpr double kTurned = 0.9986295347545738;  // cosine of 3 degrees
  const Vec3 &a = vertices[t[0]], &b = vertices[t[1]], &c = vertices[t[2]];
  const double farthest = std::max({std::abs(plane.height(a)), std::abs(plane.height(b)), std::abs(plane.height(c))});
  if (farthest <= off) return Placed::kInPlane;
  return std::abs(dot(plane.normal, unit_normal(a, b, c))) < kTurned ? Placed::kAcross : Placed::kOff;
}

}  // namespace

std::vector<Placed> placements(const SurfaceMesh& surface, const TriangleMesh& input, const TriangleNormals& normals,
                               double off) {
  auto result = sized_on_all_threads<Placed>(surface.sources.size());
  parallel_for_each(result.size(), 4096, [&](std::size_t face) {
    const std::int32_t source = surface.sources[face];
    if (source == kHole) {
      result[face] = Placed::kInPlane;
      return;
    }
    const auto triangle = static_cast<std::uint32_t>(source);
    const SourcePlane plane{input.vertices[input.triangles[triangle][0]], normals.of(triangle), source};
    result[face] = placed(surface.mesh.vertices, surface.mesh.triangles[face], plane, off);
  });
  return result;
}

bool are_mostly_in_planes(const std::vector<Placed>& placements, std::uint64_t fewer) {
  const auto in_planes = static_cast<std::uint64_t>(std::ranges::count(placements, Placed::kInPlane));
  return 4 * (in_planes + fewer) >= 3 * (placements.size() + fewer);
}

}  // namespace raycone
