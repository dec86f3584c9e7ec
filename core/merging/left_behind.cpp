#include "core/merging/left_behind.h"

#include <algorithm>
#include <cstddef>

#include "core/distance/distance.h"

namespace raycone {
namespace {

// Where a vertex is gone, faces around it have other corners. All others are as they were.
TriangleMesh changed_faces(const SurfaceMesh& surface, const MergedFaces& merged, const TriangleMesh& mesh) {
  TriangleMesh changed{mesh.vertices, {}};
  for (std::size_t face = 0; face < merged.triangles.size(); ++face) {
    const Triangle& before = surface.mesh.triangles[merged.faces[face]];
    if (merged.triangles[face] != before) changed.triangles.push_back(mesh.triangles[face]);
  }
  return changed;
}

struct Points {
  std::vector<std::uint32_t> vertices;  // their numbers
  std::vector<Vec3> places;
  std::vector<double> distances;
};

Points points_gone(const SurfaceMesh& surface, const MergedFaces& merged) {
  Points gone;
  for (std::uint32_t v = 0; v < merged.into.size(); ++v) {
    if (merged.into[v] == v) continue;
    gone.vertices.push_back(v);
    gone.places.push_back(surface.mesh.vertices[v]);
  }
  gone.distances.resize(gone.places.size());
  return gone;
}

// Those whose distances are above `most`, with distances that are not cut off.
Points farther(const Points& points, double most, const DistanceEvaluator& evaluator) {
  Points far;
  for (std::size_t n = 0; n < points.vertices.size(); ++n) {
    if (!(points.distances[n] > most)) continue;
    far.vertices.push_back(points.vertices[n]);
    far.places.push_back(points.places[n]);
  }
  far.distances.resize(far.places.size());
  evaluator.evaluate(far.places, far.distances);
  return far;
}

}  // namespace

std::vector<std::uint32_t> left_behind(const SurfaceMesh& surface, const MergedFaces& merged, const TriangleMesh& mesh,
                                       double most) {
  const TriangleMesh changed = changed_faces(surface, merged, mesh);
  if (changed.triangles.empty()) return {};
  const DistanceEvaluator evaluator(changed);
  Points gone = points_gone(surface, merged);
  evaluator.evaluate(gone.places, gone.distances, most);
  const Points far = farther(gone, most, evaluator);
  std::vector<std::uint32_t> faces(far.places.size());
  evaluator.find_nearest(far.places, faces);
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::vector<std::size_t> farthest(changed.triangles.size(), kNone);
  for (std::size_t n = 0; n < faces.size(); ++n) {
    std::size_t& best = farthest[faces[n]];
    if (best == kNone || far.distances[n] > far.distances[best]) best = n;
  }
  const double least = far.distances.empty() ? 0.0 : std::ranges::max(far.distances) / 2;
  std::vector<std::uint32_t> vertices;
  for (const std::size_t n : farthest) {
    if (n != kNone && far.distances[n] >= least) vertices.push_back(far.vertices[n]);
  }
  return vertices;
}

}  // namespace raycone
