#include "core/filling/embedded_border.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/arrangement/rule_border.h"
#include "core/arrangement/snap.h"
#include "core/arrangement/take_apart.h"
#include "core/certificate/border_components.h"
#include "core/certificate/certificate.h"
#include "core/exact/predicates.h"
#include "core/mesh/exterior_edges.h"

namespace raycone {
namespace {

constexpr std::size_t kMostPairs = 1 << 17;  // of faces that meet; of more, a look may take longer than a contour

// Whether the boundary may be empty but for how it is cut into edges: of the edges at its last vertex, two lie on each
// other. Of nearly all open meshes they do not.
bool may_be_closed(const TriangleMesh& mesh) {
  const std::vector<ExteriorEdge> edges = exterior_edges(mesh);
  if (edges.empty()) return true;
  const auto is_before = [&](std::uint32_t a, std::uint32_t b) {
    return lexicographic_order(mesh.vertices[a], mesh.vertices[b]) < 0;
  };
  std::uint32_t last = edges.front().from;
  for (const ExteriorEdge& edge : edges) last = std::max({last, edge.from, edge.to}, is_before);
  std::vector<std::uint32_t> others;  // all on one side of it
  for (const ExteriorEdge& edge : edges) {
    if (edge.from == last || edge.to == last) others.push_back(edge.from == last ? edge.to : edge.from);
  }
  for (std::size_t n = 1; n < others.size(); ++n) {
    if (collinear(mesh.vertices[last], mesh.vertices[others[0]], mesh.vertices[others[n]])) return true;
  }
  return false;
}

bool is_same(const TriangleMesh& one, const TriangleMesh& other) {
  return one.triangles == other.triangles && one.vertices == other.vertices;
}

// Makes `sources`, triangles of another border, what the sources of these are.
void look_through(std::vector<std::uint32_t>& sources, const std::vector<std::uint32_t>& beyond) {
  for (std::uint32_t& source : sources) source = beyond[source];
}

// Counts the ways that were in vain, those of vertices with copies where there are faults. Whether there were any.
// `originals`: of each vertex the one that it is a copy of, or itself.
bool count_in_vain(const TriangleMesh& apart, const std::vector<std::uint32_t>& originals,
                   std::vector<std::uint8_t>& in_vain) {
  std::vector<std::uint8_t> has_copies(originals.size(), 0), is_faulty(originals.size(), 0);
  for (std::size_t v = 0; v < originals.size(); ++v) {
    if (originals[v] != v) has_copies[originals[v]] = 1;
  }
  for (const std::uint32_t v : vertices_at_faults(apart)) is_faulty[originals[v]] = 1;
  in_vain.resize(originals.size(), 0);
  bool any = false;
  for (std::size_t v = 0; v < originals.size(); ++v) {
    if (has_copies[v] == 0 || is_faulty[v] == 0) continue;
    ++in_vain[v];
    any = true;
  }
  return any;
}

bool has_all_nodes_right(const SurfaceMesh& surface, const NodeSet& inside) {
  const std::vector<ExteriorEdge> none;
  return misplaced_nodes(surface.mesh, inside, &none).empty();
}

// With `options.other_ways`, these are tried only at vertices with faults.
std::optional<SurfaceMesh> taken_apart(const RuleBorder& border, ApartOptions options) {
  const int most_tries = options.other_ways ? 3 : 1;  // two do in nearly all cases
  for (int tries = 0; tries < most_tries; ++tries) {
    auto [mesh, sources] = border;
    const std::optional<std::vector<std::uint32_t>> originals = take_apart(mesh, sources, options);
    if (!originals) return std::nullopt;
    if (is_closed_and_embedded(mesh)) {
      SurfaceMesh surface{std::move(mesh), {sources.begin(), sources.end()}};
      if (!keep_border(surface, Rule{})) return std::nullopt;  // rounding may have turned flat components over
      return surface;
    }
    if (tries + 1 == most_tries || !count_in_vain(mesh, *originals, options.in_vain)) break;
  }
  return std::nullopt;
}

// With nodes on their sides, if possible. A node on a face counts as moved by less than any distance, along x by more
// than along y, and along y by more than along z. If the face moves the other way, the node stays on its side.
std::optional<SurfaceMesh> taken_apart_beside(const NodeSet& inside, const RuleBorder& border, ApartOptions options) {
  std::optional<SurfaceMesh> surface = taken_apart(border, options);
  const bool has_moved = surface && surface->mesh.vertices.size() != border.mesh.vertices.size();
  if (surface && (!has_moved || has_all_nodes_right(*surface, inside))) return surface;
  options.against_perturbation = true;
  std::optional<SurfaceMesh> other = taken_apart(border, options);
  return other && (!surface || has_all_nodes_right(*other, inside)) ? other : surface;
}

}  // namespace

std::optional<SurfaceMesh> embedded_border(const TriangleMesh& mesh, const NodeSet& inside,
                                           const SurfaceOptions& options) {
  constexpr int kRounds = 3;
  constexpr double kApart = 0x1p-30, kApartRoundings = 32.0;  // the larger one, voxels
  constexpr double kNear = 16.0, kFarther = 16.0;             // roundings, and so many times that the next time
  if (!may_be_closed(mesh)) return std::nullopt;
  const double rounding = relative_rounding(options.precision) * largest_coordinate(bounding_box(mesh));
  ApartOptions as{std::max(kApart * inside.lattice().least_spacing(), kApartRoundings * rounding), options.precision};
  const std::optional<RuleBorder> first = rule_border(mesh, {options.rule, options.precision, kMostPairs});
  if (!first || first->sources.empty()) return std::nullopt;
  std::optional<RuleBorder> border = first;
  TriangleMesh tried;
  const auto surface_of_border = [&]() -> std::optional<SurfaceMesh> {
    if (is_same(border->mesh, tried)) return std::nullopt;
    std::optional<SurfaceMesh> surface = taken_apart_beside(inside, *border, as);
    if (!surface) tried = border->mesh;
    return surface;
  };
  double near = kNear * rounding;
  for (int round = 0; border && !border->sources.empty(); ++round, near *= kFarther) {
    if (std::optional<SurfaceMesh> surface = surface_of_border()) return surface;
    if (round == kRounds) break;
    snap(*border, near);
    if (std::optional<SurfaceMesh> surface = surface_of_border()) return surface;
    std::optional<RuleBorder> again = rule_border(border->mesh, {Rule{}, options.precision, kMostPairs});
    if (again) look_through(again->sources, border->sources);
    border = std::move(again);
  }
  as.other_ways = true;  // at last: parts that are hardly thicker than roundings are better snapped
  return taken_apart_beside(inside, *first, as);
}

}  // namespace raycone
