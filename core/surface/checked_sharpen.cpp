#include "core/surface/checked_sharpen.h"

#include <cstddef>
#include <cstdint>
#include <utility>

#include "core/surface/certificate.h"
#include "core/surface/fault_places.h"
#include "core/surface/node_set.h"
#include "core/surface/surface_edit.h"

namespace raycone {
namespace {

void drop_gone_faces(SurfaceMesh& surface) {
  std::size_t left = 0;
  for (std::size_t face = 0; face < surface.sources.size(); ++face) {
    const Triangle t = surface.mesh.triangles[face];
    if (is_gone(t)) continue;
    surface.sources[left] = surface.sources[face];
    surface.mesh.triangles[left++] = t;
  }
  surface.mesh.triangles.resize(left);
  surface.sources.resize(left);
  surface.mesh = used_part(surface.mesh.vertices, std::move(surface.mesh.triangles));
}

}  // namespace

bool checked_sharpen(SurfaceMesh& surface, const TriangleMesh& input, const TriangleNormals& normals,
                     const Lattice& lattice, const SharpenLimits& limits, int rounds) {
  constexpr int kPartialRounds = 6;
  const std::size_t vertices = surface.mesh.vertices.size(), faces = surface.sources.size();
  const auto drop_spares = [&] {
    surface.mesh.vertices.resize(vertices);
    surface.mesh.triangles.resize(faces);
    surface.sources.resize(faces);
    return false;
  };
  Sharpener sharpener(surface, input, normals, limits);
  SurfaceEdit change = sharpener.sharpen();
  if (sharpener.pulls() == 0) return drop_spares();
  NodesSinceFirst nodes(lattice);
  for (int round = 0; round < rounds; ++round) {
    change.apply(surface.mesh);
    NearFaults near = faults_near(surface.mesh, change, lattice);
    const NodeSet& misplaced = nodes.after(change, surface.mesh, near.faults, [&] { return sharpener.changes(); });
    if (near.faults.none() && misplaced.empty()) {
      sharpener.set_sources(surface.sources);
      drop_gone_faces(surface);
      return true;
    }
    sharpener.for_each_target([&](std::uint32_t vertex, const Vec3& p) {
      if (is_beside(p, misplaced)) near.vertices.push_back(vertex);
    });
    change = sharpener.keep(near.vertices, round >= kPartialRounds);
    if (change.faces.empty()) break;  // such faults do not come from pulls
  }
  sharpener.undo().apply(surface.mesh);
  return drop_spares();
}

}  // namespace raycone
