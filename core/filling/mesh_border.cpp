#include "core/filling/mesh_border.h"

#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "core/cells/surface_mesh.h"
#include "core/certificate/border_components.h"
#include "core/certificate/certificate.h"
#include "core/data/coordinate_precision.h"
#include "core/filling/embedded_border.h"
#include "core/mesh/used_part.h"

namespace raycone {
namespace {

// Without vertices that no triangle uses.
SurfaceMesh surface_of(const TriangleMesh& mesh) {
  SurfaceMesh surface{used_part(mesh.vertices, mesh.triangles), std::vector<std::int32_t>(mesh.triangles.size())};
  std::iota(surface.sources.begin(), surface.sources.end(), 0);
  return surface;
}

}  // namespace

std::optional<MeshBorder> mesh_border(const TriangleMesh& mesh, const NodeSet& inside, const SurfaceOptions& options,
                                      std::size_t most) {
  SurfaceMesh itself = surface_of(mesh);
  round_to(options.precision, itself.mesh.vertices);
  if (!std::isfinite(largest_coordinate(bounding_box(itself.mesh)))) return std::nullopt;  // beyond floats
  if (is_closed_and_embedded(itself.mesh) && keep_border(itself, options.rule)) {
    return MeshBorder{std::move(itself), options.rule};
  }
  if (mesh.triangles.size() > most) return std::nullopt;
  std::optional<SurfaceMesh> cut = embedded_border(mesh, inside, options);
  if (!cut) return std::nullopt;
  return MeshBorder{*std::move(cut), Rule{}};  // it goes once around what it is the border of
}

}  // namespace raycone
