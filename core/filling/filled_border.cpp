#include "core/filling/filled_border.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "core/evaluation/winding_number.h"
#include "core/filling/closed_by_caps.h"
#include "core/filling/fill_check.h"
#include "core/filling/fit_to_threshold.h"
#include "core/filling/mesh_border.h"
#include "core/mesh/disjoint_sets.h"

namespace raycone {
namespace {

// How many borders hang together, about as many as there are holes.
std::size_t count_borders(const std::vector<ExteriorEdge>& edges, std::size_t vertices) {
  DisjointSets sets(vertices);
  for (const ExteriorEdge& e : edges) sets.join(e.from, e.to);
  std::vector<std::uint32_t> borders;
  for (const ExteriorEdge& e : edges) borders.push_back(sets.lowest(e.from));
  std::ranges::sort(borders);
  return static_cast<std::size_t>(std::unique(borders.begin(), borders.end()) - borders.begin());
}

// Whether holes are everywhere: what fills them lies across itself then, and is not fitted for all the time it takes.
bool is_mostly_holes(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges, std::size_t caps) {
  constexpr std::size_t kManyBorders = 64, kManyCaps = 1000, kPartOfFaces = 4;
  return caps > kManyCaps && caps * kPartOfFaces > mesh.triangles.size() &&
         count_borders(edges, mesh.vertices.size()) > kManyBorders;
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

std::optional<FilledBorder> filled_border(const SurfaceInput& input, const std::vector<ExteriorEdge>& edges,
                                          const BorderLimits& limits) {
  const auto& [mesh, evaluators, inside, options] = input;
  const TriangleMesh closed = closed_by_caps(mesh, edges);
  if (is_mostly_holes(mesh, edges, closed.triangles.size() - mesh.triangles.size())) return std::nullopt;
  if (!keeps_nodes(closed, inside, options.rule)) return std::nullopt;
  std::optional<MeshBorder> border = mesh_border(closed, inside, options, limits.cut);
  if (!border) return std::nullopt;
  SurfaceMesh& surface = border->surface;
  const auto own = static_cast<std::int32_t>(mesh.triangles.size());
  for (std::int32_t& source : surface.sources) source = source < own ? source : kHole;
  const RuleAlong along(evaluators, options.rule);
  if (!fit_to_threshold(surface, along, inside, {limits.fill, options.precision})) return std::nullopt;
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
