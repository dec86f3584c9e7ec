#include "core/filling/fill_check.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cells/surface_mesh.h"
#include "core/cells/triangle_normals.h"
#include "core/distance/distance.h"
#include "core/surface/dropped_samples.h"
#include "core/surface/surface_measures.h"

namespace raycone {
namespace {

constexpr double kNear = 0.25, kNotFar = 1.0;  // voxels
// Faces of voxels: cracks and pockets have no more in all, and bend the threshold around their rims. What separates is
// looked at in quarters of such faces.
constexpr double kLittle = 1.0, kLittleLost = 0.25;

}  // namespace

bool is_along_threshold(const SurfaceMesh& surface, const RuleAlong& along, double voxel) {
  constexpr double kLine = 0x1p-6;                    // voxels: thinner faces are as good as lines
  constexpr double kNearly = 0.9, kNearlyAll = 0.99;  // of the area: teeth of the mesh without inside are gone around
  constexpr std::size_t kPoints = 17;
  std::vector<Vec3> points;
  std::vector<double> areas;
  for (std::size_t face = 0; face < surface.sources.size(); ++face) {
    if (surface.sources[face] != kHole) continue;
    const auto [a, b, c] = corners_of(surface.mesh, surface.mesh.triangles[face]);
    const Vec3 normal = cross(b - a, c - a), middle = (1.0 / 3.0) * (a + b + c);
    if (norm(normal) < kLine * voxel * std::max({norm(b - a), norm(c - b), norm(a - c)})) continue;
    areas.push_back(0.5 * norm(normal));
    points.push_back(middle);
    for (const double reach : {kNear * voxel, kNotFar * voxel}) {
      for (const Vec3& way : {(1.0 / norm(normal)) * normal, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
        points.insert(points.end(), {middle - reach * way, middle + reach * way});
    }
  }
  const std::vector<double> values = along.roughly_near(points);
  double all = 0.0, near = 0.0, not_far = 0.0;
  for (std::size_t n = 0; n < areas.size(); ++n) {
    const auto passes = [&](std::size_t count) {
      const auto [least, most] = std::ranges::minmax(std::span(values).subspan(n * kPoints, count));
      return (least >= 0.0) != (most >= 0.0);
    };
    all += areas[n];
    near += passes(kPoints / 2 + 1) ? areas[n] : 0.0;
    not_far += passes(kPoints) ? areas[n] : 0.0;
  }
  const double little = kLittle * voxel * voxel;
  return all - near <= std::max((1.0 - kNearly) * all, little) &&
         all - not_far <= std::max((1.0 - kNearlyAll) * all, little);
}

LostArea lost_area(const SurfaceMesh& surface, const TriangleMesh& mesh, const RuleAlong& along, double voxel) {
  constexpr double kStep = 0.5, kAside = 0x1p-20, kThin = 0.5;  // voxels
  const std::vector<bool> held = held_triangles(surface, mesh);
  const double step = kStep * voxel;
  AreaSamples samples;
  for (std::uint32_t n = 0; n < held.size(); ++n) {
    if (!held[n]) add_samples(samples, mesh, n, step);
  }
  LostArea lost;
  if (samples.points.empty()) return lost;
  std::vector<double> distances(samples.points.size());
  DistanceEvaluator(surface.mesh).evaluate(samples.points, distances, kNear * voxel);
  const TriangleNormals normals(mesh);
  std::vector<Vec3> sides;
  std::vector<double> areas;
  for (std::size_t n = 0; n < distances.size(); ++n) {
    if (distances[n] <= kNear * voxel) continue;
    const Vec3& p = samples.points[n];
    const Vec3 normal = voxel * normals.of(samples.triangles[n]);
    for (const double off : {-kThin, -kAside, kAside, kThin}) sides.push_back(p + off * normal);
    areas.push_back(samples.areas[n] * step * step);
  }
  const std::vector<std::uint8_t> holds = along.holds_at(sides);
  for (std::size_t n = 0; n < areas.size(); ++n) {
    const bool behind = holds[4 * n + 1] != 0, before = holds[4 * n + 2] != 0;
    if (behind == before) continue;
    const bool is_thick = holds[behind ? 4 * n : 4 * n + 3] != 0;
    (is_thick ? lost.thick : lost.thin) += areas[n];
  }
  return lost;
}

bool keeps_what_separates(const SurfaceMesh& surface, const LostArea& lost, double voxel) {
  constexpr double kMost = 0.05;  // of the area without a source
  return lost.thick <= std::max(kMost * hole_area(surface), kLittleLost * voxel * voxel);
}

}  // namespace raycone
