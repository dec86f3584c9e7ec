#include "core/filling/mesh_as_surface.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "core/cells/edge_roots.h"
#include "core/cells/plane_tolerance.h"
#include "core/cells/surface_cells.h"
#include "core/cells/surface_mesh.h"
#include "core/cells/triangle_normals.h"
#include "core/certificate/border_components.h"
#include "core/certificate/certificate.h"
#include "core/certificate/component_signs.h"
#include "core/data/coordinate_precision.h"
#include "core/data/rule.h"
#include "core/distance/distance.h"
#include "core/evaluation/winding_number.h"
#include "core/filling/filled_border.h"
#include "core/filling/mesh_border.h"
#include "core/filling/seen_by_nodes.h"
#include "core/machine/floating_point.h"
#include "core/merging/checked_merge.h"
#include "core/mesh/components.h"
#include "core/mesh/exterior_edges.h"
#include "core/mesh/weld.h"
#include "core/surface/face_sources.h"
#include "core/surface/simplify_surface.h"
#include "core/surface/surface_in_scale.h"
#include "core/surface/surface_measures.h"

namespace raycone {
namespace {

// Contours of meshes that are finer than the lattice have 12 to 15 triangles to a cell.
constexpr std::uint64_t kMostPerCell = 12;
// Before merging there may be so many times as many: of more, a look takes longer than a contour.
constexpr double kBeforeMerging = 3.0, kBeforeBorder = 1.5;
constexpr std::uint64_t kPerFillFace = 3;  // as many of all faces there may be, once merged

// Of the faces with a source.
double own_area(const SurfaceMesh& surface) { return total_area(surface.mesh) - hole_area(surface); }

// Leaves the components that the lattice sees, as keep_border() does, and tells of the others. Returns whether it sees
// all of each, and any is left.
bool keep_seen(SurfaceMesh& surface, const TriangleMesh& mesh, const NodeSet& inside, const Rule& rule, OwnFaces& own) {
  const Components components = components_of(surface.mesh);
  const std::vector<Sight> sights = sights_of(inside, triangles_of(components, surface.mesh), surface.mesh.vertices);
  if (std::ranges::find(sights, Sight::kInPart) != sights.end()) return false;
  if (std::ranges::find(sights, Sight::kUnseen) == sights.end()) return true;
  std::vector<bool> is_seen;
  for (const Sight sight : sights) is_seen.push_back(sight == Sight::kWhole);
  const double before = own_area(surface);
  keep_components(surface, components, is_seen);
  if (!keep_border(surface, rule)) return false;  // what was within an unseen one may separate nothing now
  own.left_out = components.count - components_of(surface.mesh).count;
  const double whole = total_area(mesh);
  if (whole > 0.0) own.left_out_of_all += (before - own_area(surface)) / whole;
  return true;
}

// The signs of all components, sorted: which component has which sign is not told.
std::vector<int> sorted_signs(const TriangleMesh& mesh) {
  std::vector<int> signs = component_signs(mesh).of_component;
  std::ranges::sort(signs);
  return signs;
}

// Merges a surface that has no faults, but perhaps nodes on the wrong side; unless that makes a component flat, one
// that is thinner than planes are off each other. Returns whether all nodes are on their sides.
bool merge(FinishedSurface& made, const TriangleMesh& mesh, const NodeSet& inside, const MergeOptions& options) {
  CheckedMerge merged = checked_merge(made.surface, mesh, inside, options, {});
  made.merged = merged.surface && sorted_signs(merged.surface->mesh) == sorted_signs(made.surface.mesh);
  if (!made.merged) return misplaced_nodes(made.surface.mesh, inside).empty();
  made.surface = *std::move(merged.surface);
  return true;
}

// By pulls of `most` at most.
void simplify(FinishedSurface& made, const TriangleMesh& mesh, const NodeSet& inside, double most,
              const SurfaceOptions& options) {
  const TriangleNormals normals(mesh);
  const DistanceEvaluator distance(mesh);
  const SourceSettler settler(mesh, normals, distance, farthest_source(inside.lattice(), options.thickness));
  simplify_surface(made, inside, most, options, settler);
}

// With vertices joined that rounding alone keeps apart: cracks of such a width may run around whole faces, and what
// fills their loops would lie anywhere.
TriangleMesh without_cracks(const TriangleMesh& mesh) {
  const double rounding = 0x1p-48 * largest_coordinate(bounding_box(mesh));
  return weld(mesh, {WeldMode::kDistance, std::max(rounding, std::numeric_limits<double>::min())});
}

// Of any mesh. Adds what is too thin for the lattice to `own`. `most`: triangles, once merged.
std::optional<MeshBorder> border_of(const SurfaceInput& input, std::uint64_t most, OwnFaces& own) {
  const auto& [mesh, evaluators, inside, options] = input;
  const BorderLimits limits{static_cast<std::size_t>(kBeforeBorder * static_cast<double>(most)), most / kPerFillFace};
  const std::vector<ExteriorEdge> edges = exterior_edges(mesh);
  if (!edges.empty()) {
    const TriangleMesh joined = without_cracks(mesh);
    if (exterior_edges(joined).empty()) return mesh_border(joined, inside, options, limits.cut);
    std::optional<FilledBorder> filled = filled_border(input, edges, limits);
    if (filled) {
      own.left_out_of_all += filled->left_out_of_all;
      return MeshBorder{std::move(filled->surface), Rule{}};
    }
  }
  return mesh_border(mesh, inside, options, limits.cut);
}

std::optional<FinishedSurface> whole_mesh(const SurfaceInput& input, std::uint64_t most) {
  const auto& [mesh, evaluators, inside, options] = input;
  OwnFaces own;
  std::optional<MeshBorder> border = border_of(input, most, own);
  if (!border) return std::nullopt;
  FinishedSurface made{std::move(border->surface)};
  if (!keep_seen(made.surface, mesh, inside, border->rule, own)) return std::nullopt;
  made.own = std::move(own);
  if (!(options.simplify > 0.0)) made.own->held = held_triangles(made.surface, mesh);
  constexpr double kMargin = 0.0;  // no point is kept off nodes
  const SurfaceBounds bounds{kMargin, plane_tolerance(mesh, inside.lattice()), options.simplify};
  if (!merge(made, mesh, inside, {kMargin, bounds.merge_tolerance(), options.precision})) return std::nullopt;
  if (made.surface.sources.size() > most) return std::nullopt;
  if (options.simplify > 0.0) simplify(made, mesh, inside, bounds.farthest_pull(), options);
  return made;
}

// Where the mesh has to be rounded to floats, first to floats not above: nodes lie in the lowest planes of most meshes,
// and then stay on their sides of these.
std::optional<FinishedSurface> rounded_mesh(const SurfaceInput& input, std::uint64_t most) {
  const auto& [mesh, evaluators, inside, options] = input;
  const auto is_as_asked = [&precision = options.precision](const Vec3& p) { return rounded_to(precision, p) == p; };
  if (options.precision == CoordinatePrecision::kSingle && !std::ranges::all_of(mesh.vertices, is_as_asked)) {
    SurfaceOptions not_above = options;
    not_above.precision = CoordinatePrecision::kSingleNotAbove;
    if (auto made = whole_mesh({mesh, evaluators, inside, not_above}, most)) return made;
  }
  return whole_mesh(input, most);
}

}  // namespace

std::optional<FinishedSurface> mesh_as_surface(const SurfaceInput& input) {
  const DefaultFloatingPoint guard;
  const auto& [mesh, evaluators, inside, options] = input;
  if (options.thickness > 0.0 || !options.merge_planes) return std::nullopt;
  const std::uint64_t most = kMostPerCell * mixed_cells(inside);
  if (static_cast<double>(mesh.triangles.size()) > kBeforeMerging * static_cast<double>(most)) return std::nullopt;
  if (options.at_stage) options.at_stage("looking at the mesh itself");
  if (!is_out_of_scale(inside.lattice(), options)) return rounded_mesh(input, most);
  return made_in_scale(input, [&](const SurfaceInput& scaled) { return rounded_mesh(scaled, most); });
}

}  // namespace raycone
