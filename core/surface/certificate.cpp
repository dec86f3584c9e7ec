#include "core/surface/certificate.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "core/exact/predicates.h"
#include "core/machine/threads.h"
#include "core/mesh/edge_uses.h"
#include "core/mesh/vertex_faces.h"
#include "core/mesh/weld.h"

namespace raycone {
namespace {

std::uint64_t wrong_edges(const TriangleMesh& mesh) {
  std::uint64_t wrong = 0;
  for_each_edge(mesh, [&](const EdgeUse& use) { wrong += use.forward != 1 || use.backward != 1 ? 1 : 0; });
  return wrong;
}

// Whether the faces around a vertex, each with the edge that faces it, make up one cycle.
bool is_fan(const TriangleMesh& mesh, std::uint32_t vertex, std::span<const std::uint32_t> faces) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> steps;  // the opposite edges
  for (const std::uint32_t face : faces) {
    const Triangle& t = mesh.triangles[face];
    const std::size_t at = t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2;
    steps.emplace_back(t[(at + 1) % 3], t[(at + 2) % 3]);
  }
  if (steps.empty()) return false;
  std::ranges::sort(steps);
  std::uint32_t at = steps.front().first;
  for (std::size_t taken = 1; taken <= steps.size(); ++taken) {
    const auto step = std::ranges::lower_bound(steps, std::pair(at, std::uint32_t{0}));
    if (step == steps.end() || step->first != at) return false;
    at = step->second;
    if (at == steps.front().first) return taken == steps.size();
  }
  return false;
}

template <class IsWrong>
std::uint64_t count_wrong(std::size_t count, const IsWrong& is_wrong) {
  std::atomic<std::uint64_t> wrong = 0;
  parallel_for(count, 1024, [&](std::size_t begin, std::size_t end) {
    std::uint64_t here = 0;
    for (std::size_t n = begin; n < end; ++n) here += is_wrong(static_cast<std::uint32_t>(n)) ? 1 : 0;
    wrong += here;
  });
  return wrong;
}

std::uint64_t wrong_links(const TriangleMesh& mesh) {
  const VertexFaces faces(mesh);
  return count_wrong(mesh.vertices.size(),
                     [&](std::uint32_t vertex) { return !is_fan(mesh, vertex, faces.of(vertex)); });
}

std::uint64_t degenerate_faces(const TriangleMesh& mesh) {
  return count_wrong(mesh.triangles.size(), [&](std::uint32_t face) {
    const Triangle& t = mesh.triangles[face];
    return collinear(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
  });
}

std::uint64_t equal_vertices(const TriangleMesh& mesh) {
  std::vector<Vec3> sorted = mesh.vertices;
  std::ranges::sort(sorted, [](const Vec3& a, const Vec3& b) { return lexicographic_order(a, b) < 0; });
  std::uint64_t equal = 0;
  for (std::size_t i = 1; i < sorted.size(); ++i) equal += sorted[i] == sorted[i - 1] ? 1 : 0;
  return equal;
}

}  // namespace

NodeSet misplaced_nodes(const TriangleMesh& mesh, const NodeSet& inside) {
  NodeSet nodes = nodes_inside(WindingNumberEvaluator(mesh), Rule{}, inside.lattice());
  nodes.flip(inside);
  return nodes;
}

SurfaceFaults faults_of(const TriangleMesh& mesh, const NodeSet& inside) {
  SurfaceFaults faults;
  faults.edges = wrong_edges(mesh);
  faults.links = wrong_links(mesh);
  faults.degenerate_faces = degenerate_faces(mesh);
  faults.equal_vertices = equal_vertices(mesh);
  faults.nodes = misplaced_nodes(mesh, inside).size();
  faults.intersections = self_intersections(mesh);
  return faults;
}

std::string described(const SurfaceFaults& faults) {
  std::string text;
  const auto add = [&](std::uint64_t count, const char* what) {
    if (count > 0) text += (text.empty() ? "" : ", ") + std::to_string(count) + what;
  };
  add(faults.edges, " edges without a twin");
  add(faults.links, " vertices that are no fan");
  add(faults.degenerate_faces, " faces without area");
  add(faults.equal_vertices, " vertices in the place of others");
  add(faults.nodes, " nodes on the wrong side");
  add(faults.places, " vertices outside of their edge, face or cell");
  add(faults.intersections.pairs, " pairs of faces that intersect");
  return text;
}

}  // namespace raycone
