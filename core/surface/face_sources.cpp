#include "core/surface/face_sources.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/machine/threads.h"
#include "core/surface/edge_crossing.h"
#include "core/surface/edge_points.h"
#include "core/surface/nearest_triangle.h"

namespace raycone {
namespace {

constexpr std::size_t kFacesInTask = 4096;

struct Corners {
  const Vec3 &a, &b, &c;

  [[nodiscard]] Vec3 normal() const { return unit_normal(a, b, c); }
  // No sum overflows.
  [[nodiscard]] Vec3 middle() const { return (1.0 / 3) * a + (1.0 / 3) * b + (1.0 / 3) * c; }
};

Corners corners_of(const TriangleMesh& mesh, std::size_t face) {
  const Triangle& t = mesh.triangles[face];
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

// Fronts may look either way: rules take faces from their backs, too.
bool may_be_of(const Corners& face, const Corners& source, double off) {
  constexpr double kCosine = 0.9659258262890683;  // of 15 degrees, where creases begin to be sharp
  const Vec3 normal = source.normal();
  if (!(std::abs(dot(normal, face.normal())) >= kCosine)) return false;
  for (const Vec3* corner : {&face.a, &face.b, &face.c}) {
    if (!(std::abs(dot(normal, *corner - source.a)) <= off)) return false;
  }
  return true;
}

std::vector<std::uint32_t> doubtful_faces(const TriangleMesh& input, double off, const SurfaceMesh& surface) {
  std::vector<std::uint8_t> doubtful(surface.sources.size(), 0);
  parallel_for(doubtful.size(), kFacesInTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t face = begin; face < end; ++face) {
      const std::int32_t source = surface.sources[face];
      if (source == kHole) continue;
      const Corners of_source = corners_of(input, static_cast<std::size_t>(source));
      doubtful[face] = may_be_of(corners_of(surface.mesh, face), of_source, off) ? 0 : 1;
    }
  });
  std::vector<std::uint32_t> faces;
  for (std::uint32_t face = 0; face < doubtful.size(); ++face) {
    if (doubtful[face] != 0) faces.push_back(face);
  }
  return faces;
}

}  // namespace

void settle_sources(const TriangleMesh& input, double off, SurfaceMesh& surface) {
  const std::vector<std::uint32_t> faces = doubtful_faces(input, off, surface);
  if (faces.empty()) return;
  const NearestTriangle nearest(input);
  parallel_for(faces.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      std::int32_t& source = surface.sources[faces[n]];
      const Vec3 middle = corners_of(surface.mesh, faces[n]).middle();
      source = static_cast<std::int32_t>(nearest.of(middle, static_cast<std::uint32_t>(source)));
    }
  });
}

}  // namespace raycone
