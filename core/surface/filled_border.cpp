#include "core/surface/filled_border.h"

#include <cstddef>
#include <cstdint>
#include <utility>

#include "core/evaluation/winding_number.h"
#include "core/surface/fill_check.h"
#include "core/surface/hole_fill.h"
#include "core/surface/mesh_border.h"
#include "core/surface/surface_measures.h"

namespace raycone {
namespace {

// Whether holes are everywhere: what fills them lies across itself then, and is not fitted for all the time it takes.
bool is_mostly_holes(std::size_t faces, std::size_t caps) {
  constexpr std::size_t kMany = 1000, kPartOfFaces = 4;
  return caps > kMany && caps * kPartOfFaces > faces;
}

// Whether caps leave nearly all nodes that are inside where they are. If they do not, the threshold is far from them.
bool keeps_nodes(const TriangleMesh& closed, const NodeSet& inside, const Rule& rule) {
  constexpr std::uint64_t kPartOfNodes = 8;
  const std::vector<ExteriorEdge> none;
  NodeSet misplaced = nodes_inside(WindingNumberEvaluator(closed, {.edges = &none}), rule, inside.lattice());
  misplaced.flip(inside);
  return misplaced.size() * kPartOfNodes <= inside.size();
}

}  // namespace

std::optional<FilledBorder> filled_border(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges,
                                          const FineAndRough& evaluators, const NodeSet& inside,
                                          const SurfaceOptions& options, const BorderLimits& limits) {
  const TriangleMesh closed = closed_by_caps(mesh, edges);
  const std::size_t caps = closed.triangles.size() - mesh.triangles.size();
  if (is_mostly_holes(mesh.triangles.size(), caps)) return std::nullopt;
  if (!keeps_nodes(closed, inside, options.rule)) return std::nullopt;
  std::optional<MeshBorder> border = mesh_border(closed, inside, options, limits.cut);
  if (!border) return std::nullopt;
  SurfaceMesh& surface = border->surface;
  const auto own = static_cast<std::int32_t>(mesh.triangles.size());
  for (std::int32_t& source : surface.sources) source = source < own ? source : kHole;
  const RuleAlong along(evaluators, options.rule);
  if (!fit_to_threshold(surface, along, inside, {limits.fill, options.single_precision})) return std::nullopt;
  SurfaceOptions once = options;
  once.rule = Rule{};
  std::optional<MeshBorder> again = mesh_border(surface.mesh, inside, once, limits.cut);
  if (!again) return std::nullopt;
  for (std::int32_t& source : again->surface.sources) source = surface.sources[static_cast<std::size_t>(source)];
  const double voxel = inside.lattice().least_spacing();
  if (!is_along_threshold(again->surface, along, voxel)) return std::nullopt;
  const LostArea lost = lost_area(again->surface, mesh, along, voxel);
  if (!keeps_what_separates(again->surface, lost, voxel)) return std::nullopt;
  return FilledBorder{std::move(again->surface), lost.thin / total_area(mesh)};
}

}  // namespace raycone
