#include "core/surface/mesh_as_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "core/data/rule.h"
#include "core/data/single_precision.h"
#include "core/distance/distance.h"
#include "core/evaluation/winding_number.h"
#include "core/exact/volume_sign.h"
#include "core/machine/floating_point.h"
#include "core/mesh/components.h"
#include "core/mesh/exterior_edges.h"
#include "core/mesh/weld.h"
#include "core/surface/certificate.h"
#include "core/surface/checked_merge.h"
#include "core/surface/checked_simplify.h"
#include "core/surface/component_signs.h"
#include "core/surface/edge_points.h"
#include "core/surface/edge_roots.h"
#include "core/surface/embedded_border.h"
#include "core/surface/face_points.h"
#include "core/surface/face_sources.h"
#include "core/surface/fault_places.h"
#include "core/surface/fill_check.h"
#include "core/surface/hole_fill.h"
#include "core/surface/seen_by_nodes.h"
#include "core/surface/source_plane.h"
#include "core/surface/surface_cells.h"
#include "core/surface/surface_in_scale.h"
#include "core/surface/surface_measures.h"
#include "core/surface/triangle_normals.h"

namespace raycone {
namespace {

// Contours of meshes that are finer than the lattice have 12 to 15 triangles to a cell.
constexpr std::uint64_t kMostPerCell = 12;
// Before merging there may be so many times as many: of more, a look takes longer than a contour.
constexpr double kBeforeMerging = 3.0, kBeforeBorder = 1.5;

using Parts = std::vector<std::vector<Triangle>>;  // of each component its triangles

Parts parts_of(const TriangleMesh& mesh, const Components& components) {
  Parts parts(components.count);
  for (const Triangle& t : mesh.triangles) parts[components.of_vertex[t[0]]].push_back(t);
  return parts;
}

// The vertex that is the last one by x, then y, then z.
Vec3 last_vertex(const std::vector<Triangle>& triangles, const std::vector<Vec3>& vertices) {
  const auto is_before = [](const Vec3& a, const Vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); };
  Vec3 last = vertices[triangles.front()[0]];
  for (const Triangle& t : triangles) {
    for (const std::uint32_t v : t) last = std::max(last, vertices[v], is_before);
  }
  return last;
}

// The winding numbers around each component. A sample at its last vertex counts as moved to where nothing else of the
// component is, so it is outside of it: its winding number is what the others make of it.
std::vector<double> winding_numbers_around(const Parts& components, const TriangleMesh& mesh) {
  std::vector<double> around(components.size(), 0.0);
  if (components.size() == 1) return around;  // there are no others
  std::vector<Vec3> points(components.size());
  std::ranges::transform(components, points.begin(),
                         [&](const std::vector<Triangle>& part) { return last_vertex(part, mesh.vertices); });
  const std::vector<ExteriorEdge> none;
  WindingNumberEvaluator(mesh, {.edges = &none}).evaluate(points, around);
  return around;
}

// Leaves these components.
void keep(SurfaceMesh& surface, const Components& components, const std::vector<bool>& kept) {
  SurfaceMesh left;
  for (std::size_t face = 0; face < surface.sources.size(); ++face) {
    const Triangle& t = surface.mesh.triangles[face];
    if (!kept[components.of_vertex[t[0]]]) continue;
    left.mesh.triangles.push_back(t);
    left.sources.push_back(surface.sources[face]);
  }
  left.mesh = used_part(surface.mesh.vertices, std::move(left.mesh.triangles));
  surface = std::move(left);
}

// Leaves the components at which the rule ceases to hold: it does behind them, and not in front. Returns whether no
// other one is its border, too, the wrong way around, and any is left. Precondition: the mesh is closed and free of
// self-intersections.
bool keep_border(SurfaceMesh& surface, const Rule& rule) {
  const Components components = components_of(surface.mesh);
  const Parts parts = parts_of(surface.mesh, components);
  const std::vector<double> around = winding_numbers_around(parts, surface.mesh);
  std::vector<bool> is_border(parts.size());
  for (std::size_t n = 0; n < parts.size(); ++n) {
    const int sign = volume_sign(parts[n], surface.mesh.vertices);
    const double front = sign > 0 ? around[n] : around[n] - 1.0, behind = front + 1.0;
    if (sign == 0 || (holds(rule, front) && !holds(rule, behind))) return false;
    is_border[n] = !holds(rule, front) && holds(rule, behind);
  }
  keep(surface, components, is_border);
  return !surface.sources.empty();
}

double area_of(const TriangleMesh& mesh) {
  double area = 0.0;
  for (const Triangle& t : mesh.triangles) area += area_of_triangle(mesh, t);
  return area;
}

// Of the faces with a source.
double own_area(const SurfaceMesh& surface) { return area_of(surface.mesh) - hole_area(surface); }

// Leaves the components that the lattice sees, as keep_border() does, and tells of the others. Returns whether it sees
// all of each, and any is left.
bool keep_seen(SurfaceMesh& surface, const TriangleMesh& mesh, const NodeSet& inside, const Rule& rule, OwnFaces& own) {
  const Components components = components_of(surface.mesh);
  const std::vector<Sight> sights = sights_of(inside, parts_of(surface.mesh, components), surface.mesh.vertices);
  if (std::ranges::find(sights, Sight::kInPart) != sights.end()) return false;
  if (std::ranges::find(sights, Sight::kUnseen) == sights.end()) return true;
  std::vector<bool> is_seen;
  for (const Sight sight : sights) is_seen.push_back(sight == Sight::kWhole);
  const double before = own_area(surface);
  keep(surface, components, is_seen);
  if (!keep_border(surface, rule)) return false;  // what was within an unseen one may separate nothing now
  own.left_out = components.count - components_of(surface.mesh).count;
  const double whole = area_of(mesh);
  if (whole > 0.0) own.left_out_of_all += (before - own_area(surface)) / whole;
  return true;
}

// Without vertices that no triangle uses.
SurfaceMesh surface_of(const TriangleMesh& mesh) {
  SurfaceMesh surface{used_part(mesh.vertices, mesh.triangles), std::vector<std::int32_t>(mesh.triangles.size())};
  std::iota(surface.sources.begin(), surface.sources.end(), 0);
  return surface;
}

// Of all components, in no order that says which is which.
std::vector<int> sorted_signs(const TriangleMesh& mesh) {
  std::vector<int> signs = component_signs(mesh).of_component;
  std::ranges::sort(signs);
  return signs;
}

// Of a surface without faults, but perhaps with nodes on the wrong side: whether it has none. Merged, if it could be
// without making flat a component that is thinner than planes are off each other.
bool merge(FinishedSurface& made, const TriangleMesh& mesh, const NodeSet& inside, const MergeOptions& options) {
  CheckedMerge merged = checked_merge(made.surface, mesh, inside, options, {});
  made.merged = merged.surface && sorted_signs(merged.surface->mesh) == sorted_signs(made.surface.mesh);
  if (!made.merged) return misplaced_nodes(made.surface.mesh, inside).empty();
  made.surface = *std::move(merged.surface);
  return true;
}

// `most`: how far pulls may be, so that the surface moves by `options.simplify` at most.
void simplify(FinishedSurface& made, const TriangleMesh& mesh, const NodeSet& inside, double most,
              const SurfaceOptions& options) {
  made.bound_too_small = !(most > 0.0);
  made.simplified = !made.bound_too_small && checked_simplify(made.surface, inside, most, options.rounds);
  if (!made.simplified) return;
  const TriangleNormals normals(mesh);
  const DistanceEvaluator distance(mesh);
  const SourceSettler settler(mesh, normals, distance, farthest_source(inside.lattice(), 0.0));
  settler.settle(made.surface);
  settler.forget_far_sources(made.surface, options.simplify);
}

// What there is to know of the mesh and the lattice.
struct Input {
  const TriangleMesh& mesh;
  const FineAndRough& evaluators;
  const NodeSet& inside;
  const SurfaceOptions& options;
  std::uint64_t most;  // triangles, once merged
};

// Of a closed mesh: itself or, where it has faults, what is cut out of it. `rule`: of its winding numbers; that of the
// border's then.
std::optional<SurfaceMesh> border_of(const TriangleMesh& closed, const Input& input, Rule& rule) {
  SurfaceMesh itself = surface_of(closed);
  if (input.options.single_precision) round_to_float(itself.mesh.vertices);
  if (!std::isfinite(largest_coordinate(bounding_box(itself.mesh)))) return std::nullopt;  // beyond floats
  if (is_closed_and_embedded(itself.mesh) && keep_border(itself, rule)) return itself;
  const double most = kBeforeBorder * static_cast<double>(input.most);
  if (static_cast<double>(closed.triangles.size()) > most) return std::nullopt;
  SurfaceOptions options = input.options;
  options.rule = std::exchange(rule, Rule{});  // it goes once around what it is the border of
  return embedded_border(closed, input.inside, options);
}

// Whether caps leave nearly all nodes that are inside where they are. If they do not, the threshold is far from them.
bool keeps_nodes(const TriangleMesh& closed, const NodeSet& inside, const Rule& rule) {
  constexpr std::uint64_t kPartOfNodes = 8;
  const std::vector<ExteriorEdge> none;
  NodeSet misplaced = nodes_inside(WindingNumberEvaluator(closed, {.edges = &none}), rule, inside.lattice());
  misplaced.flip(inside);
  return misplaced.size() * kPartOfNodes <= inside.size();
}

// With vertices joined that rounding alone keeps apart: cracks of such a width may run around whole faces, and what
// fills their loops would lie anywhere.
TriangleMesh without_cracks(const TriangleMesh& mesh) {
  const double rounding = 0x1p-48 * largest_coordinate(bounding_box(mesh));
  return weld(mesh, {WeldMode::kDistance, std::max(rounding, std::numeric_limits<double>::min())});
}

// The surface of an open mesh, with faces that close its holes along the threshold. `left_out`: what is
// too thin for the lattice, as a part of the mesh's area.
std::optional<SurfaceMesh> filled_border(const Input& input, const std::vector<ExteriorEdge>& edges, double& left_out) {
  constexpr std::uint64_t kPerFillFace = 3;  // as many of all faces there may be, once merged
  const auto& [mesh, evaluators, inside, options, most] = input;
  Rule rule = options.rule;
  const TriangleMesh closed = closed_by_caps(mesh, edges);
  if (!keeps_nodes(closed, inside, rule)) return std::nullopt;
  std::optional<SurfaceMesh> border = border_of(closed, input, rule);
  if (!border) return std::nullopt;
  const auto own = static_cast<std::int32_t>(mesh.triangles.size());
  for (std::int32_t& source : border->sources) source = source < own ? source : kHole;
  const RuleAlong along(evaluators, options.rule);
  if (!fit_to_threshold(*border, along, inside, {most / kPerFillFace, options.single_precision})) return std::nullopt;
  rule = Rule{};
  std::optional<SurfaceMesh> again = border_of(border->mesh, input, rule);
  if (!again) return std::nullopt;
  for (std::int32_t& source : again->sources) source = border->sources[static_cast<std::size_t>(source)];
  const double voxel = inside.lattice().least_spacing();
  if (!is_along_threshold(*again, along, voxel)) return std::nullopt;
  const LostArea lost = lost_area(*again, mesh, along, voxel);
  if (!keeps_what_separates(*again, lost, voxel)) return std::nullopt;
  left_out = lost.thin / area_of(mesh);
  return again;
}

std::optional<FinishedSurface> whole_mesh(const Input& input) {
  const auto& [mesh, evaluators, inside, options, most] = input;
  const std::vector<ExteriorEdge> edges = exterior_edges(mesh);
  Rule rule = options.rule;
  OwnFaces own;
  std::optional<SurfaceMesh> border;
  if (edges.empty()) {
    border = border_of(mesh, input, rule);
  } else if (const TriangleMesh joined = without_cracks(mesh); exterior_edges(joined).empty()) {
    border = border_of(joined, input, rule);
  } else if (border = filled_border(input, edges, own.left_out_of_all); border) {
    rule = Rule{};
  } else {
    border = border_of(mesh, input, rule);  // the boundary may be empty but for how it is cut into edges
  }
  if (!border) return std::nullopt;
  FinishedSurface made{*std::move(border)};
  if (!keep_seen(made.surface, mesh, inside, rule, own)) return std::nullopt;
  made.own = std::move(own);
  if (!(options.simplify > 0.0)) made.own->held = held_triangles(made.surface, mesh);
  constexpr double kMargin = 0.0;  // no point is kept off nodes
  const SurfaceBounds bounds{kMargin, plane_tolerance(mesh, inside.lattice()), options.simplify};
  if (!merge(made, mesh, inside, {kMargin, bounds.merge_tolerance(), options.single_precision})) return std::nullopt;
  if (made.surface.sources.size() > most) return std::nullopt;
  if (options.simplify > 0.0) simplify(made, mesh, inside, bounds.farthest_pull(), options);
  return made;
}

}  // namespace

std::optional<FinishedSurface> mesh_as_surface(const TriangleMesh& mesh, const FineAndRough& evaluators,
                                               const NodeSet& inside, const SurfaceOptions& options) {
  const DefaultFloatingPoint guard;
  if (options.thickness > 0.0 || !options.merge_planes) return std::nullopt;
  const std::uint64_t most = kMostPerCell * mixed_cells(inside);
  if (static_cast<double>(mesh.triangles.size()) > kBeforeMerging * static_cast<double>(most)) return std::nullopt;
  if (options.at_stage) options.at_stage("looking at the mesh itself");
  if (!is_out_of_scale(inside.lattice(), options)) return whole_mesh({mesh, evaluators, inside, options, most});
  const auto make = [&](const TriangleMesh& scaled, const NodeSet& nodes, const SurfaceOptions& as) {
    const WindingNumberEvaluator evaluator(scaled);
    return whole_mesh({scaled, evaluator, nodes, as, most});
  };
  return made_in_scale(mesh, inside, options, make);
}

}  // namespace raycone
