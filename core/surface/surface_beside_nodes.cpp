#include "core/surface/surface_beside_nodes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/cells/source_plane.h"
#include "core/certificate/certificate.h"
#include "core/data/coordinate_precision.h"
#include "core/distance/distance.h"
#include "core/merging/mesh_corners.h"

namespace raycone {
namespace {

// Voxels, between -0.4 and 0.4: the n-th of places that are spread over a cube (Roberts 2018, "The unreasonable
// effectiveness of quasirandom sequences").
double step_off_nodes(int n, int axis) {
  constexpr std::array kSpread{0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
  const double place = n * kSpread[static_cast<std::size_t>(axis)];
  return 0.8 * (place - std::floor(place) - 0.5);
}

// Whether points next to corners, and in level planes, can be moved so that the surface has no faults.
bool put_nodes_right(SurfaceMesh& surface, const TriangleMesh& input, const NodeSet& inside,
                     const BesideNodesLimits& limits) {
  for (const PointMoves moves : {PointMoves::kToCorners, PointMoves::kIntoLevelPlanes}) {
    TriangleMesh moved = surface.mesh;
    move_points(moves, input, surface.sources, inside.lattice(), limits.to_corners, moved);
    round_to(limits.precision, moved.vertices);
    if (!faults_of(moved, inside).none()) continue;
    surface.mesh = std::move(moved);
    return true;
  }
  return false;
}

bool has_points(const SurfaceMesh& surface, std::span<const Vec3> points, double off) {
  std::vector<double> distances(points.size());
  DistanceEvaluator(surface.mesh).evaluate(points, distances, off);
  return std::ranges::max(distances) <= off;
}

}  // namespace

bool is_of_planes(const SurfaceMesh& surface, const TriangleMesh& input, double off) {
  constexpr double kMost = 0.75;  // of the area, which scans stay below (see face_placement.h)
  double all = 0.0, in_planes = 0.0;
  for (std::size_t face = 0; face < surface.sources.size(); ++face) {
    const Triangle& t = surface.mesh.triangles[face];
    const std::vector<Vec3>& v = surface.mesh.vertices;
    const double area = norm(cross(v[t[1]] - v[t[0]], v[t[2]] - v[t[0]]));
    all += area;
    if (surface.sources[face] == kHole) continue;
    const SourcePlane plane = source_plane(input, surface.sources[face]);
    const auto is_in_plane = [&](std::uint32_t corner) { return std::abs(plane.height(v[corner])) <= off; };
    if (std::ranges::all_of(t, is_in_plane)) in_planes += area;
  }
  return in_planes >= kMost * all;
}

// Corners that one lattice does not see the next one may: others are tried where less than an eighth of the faces would
// do.
std::optional<SurfaceMesh> surface_beside_nodes(const TriangleMesh& input, const NodeSet& inside,
                                                std::span<const Vec3> points, const BesideNodesLimits& limits,
                                                const MergedSurface& merged_surface) {
  constexpr int kTries = 6;
  constexpr std::size_t kPrize = 4;  // of `faces`, which is half of what there is
  for (int n = 1; n <= kTries; ++n) {
    Lattice moved = inside.lattice();
    for (int axis = 0; axis < 3; ++axis) moved.origin[axis] += step_off_nodes(n, axis) * moved.spacing[axis];
    std::optional<SurfaceMesh> surface = merged_surface(moved);
    if (!surface) continue;
    const std::size_t faces = surface->mesh.triangles.size();
    if (faces >= limits.faces) break;
    if (put_nodes_right(*surface, input, inside, limits)) {
      if (has_points(*surface, points, limits.off)) return surface;
      break;
    }
    if (kPrize * faces > limits.faces) break;
  }
  return std::nullopt;
}

}  // namespace raycone
