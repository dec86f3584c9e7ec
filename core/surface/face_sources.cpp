#include "core/surface/face_sources.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/cells/cell_creases.h"
#include "core/cells/surface_mesh.h"
#include "core/cells/unit_normal.h"
#include "core/machine/numbers_where.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

constexpr std::size_t kFacesInTask = 4096;

Vec3 normal_of(const Corners3& face) { return unit_normal(face[0], face[1], face[2]); }

// No sum overflows.
Vec3 middle_of(const Corners3& face) { return (1.0 / 3) * face[0] + (1.0 / 3) * face[1] + (1.0 / 3) * face[2]; }

// Whether the face is at 15 degrees or less to a plane with this normal, of length 1. Fronts may look either way: rules
// take faces from their backs, too. A few roundings decide nothing by themselves: then the exact normal is asked.
bool is_along(const Corners3& face, const Vec3& normal) {
  constexpr double kDoubt = 1e-9, kNeedle = 1e-10, kLeast = 1e-200, kMost = 1e200;
  const Vec3 u = face[1] - face[0], v = face[2] - face[0], across = cross(u, v);
  const double size = dot(across, across), cosine = dot(normal, across);
  const double excess = cosine * cosine - kSharpCosine * kSharpCosine * size;
  const bool is_sure = size > kNeedle * dot(u, u) * dot(v, v) && std::abs(excess) > kDoubt * size;
  if (is_sure && size > kLeast && size < kMost) return excess > 0.0;
  return std::abs(dot(normal, normal_of(face))) >= kSharpCosine;
}

// Faces beside one that closes a hole, and in line with it, close it too, if they are on no triangle: at a rim all of
// their corners may be. `may_close`: of each face, whether it is on none.
void spread_holes(const std::vector<std::uint8_t>& may_close, SurfaceMesh& surface) {
  std::vector<std::uint32_t> closing;
  for (std::uint32_t face = 0; face < surface.sources.size(); ++face) {
    if (surface.sources[face] == kHole) closing.push_back(face);
  }
  if (closing.empty()) return;
  using Edge = std::pair<std::uint32_t, std::uint32_t>;  // as a face runs along it
  const auto edge = [&](std::uint32_t face, std::size_t i) {
    const Triangle& t = surface.mesh.triangles[face];
    return Edge{t[i], t[(i + 1) % 3]};
  };
  const auto normal_at = [&mesh = surface.mesh](std::uint32_t face) {
    return normal_of(corners_of(mesh, mesh.triangles[face]));
  };
  std::vector<std::pair<Edge, std::uint32_t>> edges;
  for (std::uint32_t face = 0; face < may_close.size(); ++face) {
    for (std::size_t i = 0; may_close[face] != 0 && i < 3; ++i) edges.emplace_back(edge(face, i), face);
  }
  std::ranges::sort(edges);
  while (!closing.empty()) {
    const std::uint32_t face = closing.back();
    closing.pop_back();
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [from, to] = edge(face, i);
      const auto beside = std::ranges::lower_bound(edges, std::pair(Edge{to, from}, std::uint32_t{0}));
      if (beside == edges.end() || beside->first != Edge{to, from}) continue;
      std::int32_t& source = surface.sources[beside->second];
      if (source == kHole || !(dot(normal_at(face), normal_at(beside->second)) >= kSharpCosine)) continue;
      source = kHole;
      closing.push_back(beside->second);
    }
  }
}

}  // namespace

SourceSettler::SourceSettler(const TriangleMesh& input, const TriangleNormals& normals,
                             const DistanceEvaluator& distance, double off)
    : input_(input), normals_(normals), distance_(distance), off_(off) {}

bool SourceSettler::may_be_of(const SurfaceMesh& surface, std::size_t number, std::uint32_t source) const {
  const Corners3 face = corners_of(surface.mesh, surface.mesh.triangles[number]);
  const Vec3 &point = input_.vertices[input_.triangles[source][0]], normal = normals_.of(source);
  return std::ranges::all_of(face, [&](const Vec3& p) { return std::abs(dot(normal, p - point)) <= off_; }) &&
         is_along(face, normal);
}

std::vector<std::uint32_t> SourceSettler::doubtful_faces(const SurfaceMesh& surface) const {
  std::vector<std::uint8_t> doubtful(surface.sources.size(), 0);
  parallel_for_each(doubtful.size(), kFacesInTask, [&](std::size_t face) {
    if (surface.sources[face] == kHole) return;
    doubtful[face] = may_be_of(surface, face, static_cast<std::uint32_t>(surface.sources[face])) ? 0 : 1;
  });
  return numbers_where(doubtful.size(), [&](std::uint32_t face) { return doubtful[face] != 0; });
}

void SourceSettler::settle(SurfaceMesh& surface) const {
  const std::vector<std::uint32_t> faces = doubtful_faces(surface);
  if (faces.empty()) return;
  std::vector<Vec3> middles;
  middles.reserve(faces.size());
  for (const std::uint32_t face : faces) {
    middles.push_back(middle_of(corners_of(surface.mesh, surface.mesh.triangles[face])));
  }
  std::vector<std::uint32_t> nearest(faces.size());
  distance_.find_nearest(middles, nearest);
  std::vector<std::uint8_t> off_mesh(surface.sources.size(), 0);
  parallel_for_each(faces.size(), kFacesInTask, [&](std::size_t n) {
    surface.sources[faces[n]] = static_cast<std::int32_t>(nearest[n]);
    off_mesh[faces[n]] = may_be_of(surface, faces[n], nearest[n]) ? 0 : 1;
  });
  spread_holes(off_mesh, surface);
}

void SourceSettler::forget_far_sources(SurfaceMesh& surface, double most) const {
  const std::vector<Vec3>& vertices = surface.mesh.vertices;
  std::vector<double> distances(vertices.size());
  distance_.evaluate(vertices, distances, most);
  for (std::size_t face = 0; face < surface.sources.size(); ++face) {
    const bool is_far = std::ranges::any_of(surface.mesh.triangles[face],
                                            [&](std::uint32_t corner) { return distances[corner] > most; });
    if (is_far) surface.sources[face] = kHole;
  }
}

}  // namespace raycone
