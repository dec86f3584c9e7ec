#include "core/certificate/certificate.h"

#include <algorithm>
#include <atomic>
#include <span>
#include <tuple>
#include <utility>

#include "core/cells/cell_set.h"
#include "core/cells/surface_mesh.h"
#include "core/exact/predicates.h"
#include "core/intersections/vertex_graph.h"
#include "core/machine/buckets.h"
#include "core/machine/first_touch.h"
#include "core/machine/numbers_where.h"
#include "core/machine/sum_over.h"
#include "core/machine/threads.h"
#include "core/mesh/edge_uses.h"
#include "core/mesh/equal_vertices.h"
#include "core/mesh/exterior_edges.h"
#include "core/mesh/vertex_faces.h"

namespace raycone {
namespace {

std::uint64_t wrong_edges(const TriangleMesh& mesh) {
  std::uint64_t wrong = 0;
  for_each_edge(mesh, [&](const EdgeUse& use) { wrong += use.forward != 1 || use.backward != 1 ? 1 : 0; });
  return wrong;
}

constexpr std::size_t kFewSteps = 16;

// Whether the steps make up one cycle that takes each of them; without sorting, which takes longer than few looks.
// Where two steps start alike, the second is never taken.
bool is_short_cycle(std::span<const FanStep> steps) {
  std::uint32_t at = steps.front().first;
  for (std::size_t taken = 1; taken <= steps.size(); ++taken) {
    const auto step = std::ranges::find(steps, at, [](const auto& each) { return each.first; });
    if (step == steps.end()) return false;
    at = step->second;
    if (at == steps.front().first) return taken == steps.size();
  }
  return false;
}

// Whether the faces around a vertex, each with the edge that faces it, make up one cycle. Sets `steps` to these edges.
bool is_fan(const TriangleMesh& mesh, std::uint32_t vertex, std::span<const std::uint32_t> faces,
            std::vector<FanStep>& steps) {
  steps.clear();
  for (const std::uint32_t face : faces) {
    const Triangle& t = mesh.triangles[face];
    const std::size_t at = place_in(t, vertex);
    steps.emplace_back(t[(at + 1) % 3], t[(at + 2) % 3]);
  }
  if (steps.empty()) return false;
  if (steps.size() <= kFewSteps) return is_short_cycle(steps);
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

// What there is around each vertex.
struct Fans {
  std::vector<std::uint8_t> wrong;   // whether its faces are no single fan
  std::vector<std::uint8_t> graphs;  // whether they are one, and surely meet in nothing but what they share

  [[nodiscard]] std::uint64_t count_of_wrong() const {
    return static_cast<std::uint64_t>(std::ranges::count(wrong, 1));
  }
};

// `whole`: of each vertex whether all of its faces are there; nothing is said of others.
Fans fans_of(const TriangleMesh& mesh, const std::vector<std::uint8_t>* whole = nullptr) {
  const VertexFaces faces(mesh);
  Fans fans{std::vector<std::uint8_t>(mesh.vertices.size(), 0), std::vector<std::uint8_t>(mesh.vertices.size(), 0)};
  parallel_for(mesh.vertices.size(), 1024, [&](std::size_t begin, std::size_t end) {
    std::vector<FanStep> steps;
    for (auto vertex = static_cast<std::uint32_t>(begin); vertex < end; ++vertex) {
      if (whole && (*whole)[vertex] == 0) continue;
      const bool fan = is_fan(mesh, vertex, faces.of(vertex), steps);
      fans.wrong[vertex] = fan ? 0 : 1;
      fans.graphs[vertex] = fan && is_surely_graph(mesh.vertices, vertex, steps) ? 1 : 0;
    }
  });
  return fans;
}

bool is_degenerate(const TriangleMesh& mesh, std::size_t face) {
  const Triangle& t = mesh.triangles[face];
  return collinear(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
}

std::uint64_t degenerate_faces(const TriangleMesh& mesh) {
  return sum_over(mesh.triangles.size(), [&](std::size_t face) { return is_degenerate(mesh, face); });
}

// How many vertices there are, beyond the first, at positions of several. Marks all of these where `marked` is not
// null.
std::uint64_t equal_vertices(const std::vector<Vec3>& vertices, std::vector<std::uint8_t>* marked = nullptr) {
  constexpr std::size_t kBuckets = 1024;
  const VertexHash hash;
  const Buckets<std::uint32_t> buckets(vertices.size(), kBuckets, [&](std::size_t begin, std::size_t end, auto emit) {
    for (std::size_t v = begin; v < end; ++v) {
      const Vec3 without_signs = vertices[v] + Vec3{0.0, 0.0, 0.0};  // of zeros, which are equal
      emit(hash(without_signs) % kBuckets, static_cast<std::uint32_t>(v));
    }
  });
  std::atomic<std::uint64_t> equal = 0;
  parallel_for_each(kBuckets, 8, [&](std::size_t n) {
    const std::span<std::uint32_t> bucket = buckets[n];
    std::ranges::sort(bucket, {}, [&](std::uint32_t v) {
      const Vec3& p = vertices[v];
      return std::tuple(p.x, p.y, p.z);
    });
    for (std::size_t i = 1; i < bucket.size(); ++i) {
      if (vertices[bucket[i]] != vertices[bucket[i - 1]]) continue;
      if (marked) (*marked)[bucket[i - 1]] = (*marked)[bucket[i]] = 1;  // nobody else has these
      ++equal;
    }
  });
  return equal;
}

// Some faces of a mesh, and the vertices that they have.
struct MeshPart {
  TriangleMesh mesh;
  std::vector<std::uint32_t> faces, vertices;  // their numbers in the whole
  std::vector<std::uint8_t> changed;           // of each face, whether it has
  std::vector<std::uint8_t> whole;             // of each vertex, whether the part has all of its faces
};

// Gives the part all changed faces, and those whose boxes may meet one's.
void add_faces_near(const TriangleMesh& mesh, const SurfaceEdit& change, const Lattice& lattice, MeshPart& part) {
  CellSet cells(lattice);
  auto cell_of = sized_on_all_threads<CellSet::Cell>(mesh.vertices.size());
  parallel_for_each(cell_of.size(), 4096, [&](std::size_t v) { cell_of[v] = cells.cell_of(mesh.vertices[v]); });
  const auto range_of = [&](const Triangle& t) {
    return CellSet::range_of(cell_of[t[0]], cell_of[t[1]], cell_of[t[2]]);
  };
  for (const std::uint32_t face : change.faces) {
    if (!is_gone(mesh.triangles[face])) cells.insert(range_of(mesh.triangles[face]));
  }
  auto is_near = sized_on_all_threads<std::uint8_t>(mesh.triangles.size());
  parallel_for(is_near.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (auto face = static_cast<std::uint32_t>(begin); face < end; ++face)
      is_near[face] = !is_gone(mesh.triangles[face]) && cells.meets(range_of(mesh.triangles[face])) ? 1 : 0;
  });
  constexpr std::uint8_t kChanged = 2;
  for (const std::uint32_t face : change.faces) {
    if (is_near[face] != 0) is_near[face] = kChanged;
  }
  part.faces = numbers_where(is_near.size(), [&](std::uint32_t face) { return is_near[face] != 0; });
  part.changed.resize(part.faces.size());
  parallel_for_each(part.faces.size(), 4096,
                    [&](std::size_t n) { part.changed[n] = is_near[part.faces[n]] == kChanged ? 1 : 0; });
}

// The vertices that some faces have, in increasing order. Sets their places there in `number`.
std::vector<std::uint32_t> vertices_of(const TriangleMesh& mesh, const std::vector<std::uint32_t>& faces,
                                       std::vector<std::uint32_t>& number) {
  std::vector<std::uint8_t> used(mesh.vertices.size(), 0);
  parallel_for_each(faces.size(), 4096, [&](std::size_t n) {
    for (const std::uint32_t corner : mesh.triangles[faces[n]])
      std::atomic_ref(used[corner]).store(1, std::memory_order_relaxed);
  });
  std::vector<std::uint32_t> vertices = numbers_where(used.size(), [&](std::uint32_t v) { return used[v] != 0; });
  resize_on_all_threads(number, mesh.vertices.size());
  parallel_for_each(vertices.size(), 4096, [&](std::size_t n) { number[vertices[n]] = static_cast<std::uint32_t>(n); });
  return vertices;
}

// The boxes of all faces at a vertex of a changed face meet that one's.
MeshPart part_near(const TriangleMesh& mesh, const SurfaceEdit& change, const Lattice& lattice) {
  MeshPart part;
  add_faces_near(mesh, change, lattice, part);
  std::vector<std::uint32_t> number;
  part.vertices = vertices_of(mesh, part.faces, number);
  resize_on_all_threads(part.mesh.vertices, part.vertices.size());
  resize_on_all_threads(part.mesh.triangles, part.faces.size());
  parallel_for_each(part.vertices.size(), 4096,
                    [&](std::size_t n) { part.mesh.vertices[n] = mesh.vertices[part.vertices[n]]; });
  parallel_for_each(part.faces.size(), 4096, [&](std::size_t n) {
    const Triangle& t = mesh.triangles[part.faces[n]];
    part.mesh.triangles[n] = {number[t[0]], number[t[1]], number[t[2]]};
  });
  part.whole.assign(part.vertices.size(), 0);
  for (const std::uint32_t face : change.faces) {
    if (is_gone(mesh.triangles[face])) continue;
    for (const std::uint32_t corner : mesh.triangles[face]) part.whole[number[corner]] = 1;
  }
  return part;
}

// What lies between two states of a closed mesh: the faces of the one, and those of the other turned around. It is
// closed, too.
TriangleMesh mesh_between(const TriangleMesh& mesh, const SurfaceEdit& change) {
  constexpr std::uint32_t kNone = 0xFFFFFFFF;
  TriangleMesh between;
  std::vector<std::uint32_t> before(mesh.vertices.size(), kNone), after;
  std::vector<std::uint32_t> moved(mesh.vertices.size(), kNone);  // places in `change`
  for (std::uint32_t n = 0; n < change.vertices.size(); ++n) moved[change.vertices[n]] = n;
  after.assign(change.vertices.size(), kNone);
  const auto number_of = [&](std::uint32_t v, bool is_after) {
    const bool is_moved = moved[v] != kNone;
    std::uint32_t& number = is_moved && is_after ? after[moved[v]] : before[v];
    if (number != kNone) return number;
    number = static_cast<std::uint32_t>(between.vertices.size());
    between.vertices.push_back(is_moved && !is_after ? change.places[moved[v]].before : mesh.vertices[v]);
    return number;
  };
  for (const auto& [old, now] : change.corners) {
    if (!is_gone(old))
      between.triangles.push_back({number_of(old[0], false), number_of(old[2], false), number_of(old[1], false)});
    if (!is_gone(now))
      between.triangles.push_back({number_of(now[0], true), number_of(now[1], true), number_of(now[2], true)});
  }
  return between;
}

// The rows that a box may have nodes of.
LatticeBlock rows_at(const Box& box, const Lattice& lattice) {
  LatticeBlock rows = whole(lattice);
  for (const int axis : {1, 2}) {
    const auto a = static_cast<std::size_t>(axis);
    const auto row = [&](std::int64_t n) { return std::clamp<std::int64_t>(n, 0, lattice.counts[a] - 1); };
    const std::int64_t low = row(lattice.cell_at(axis, box.lower[axis]) - 1);
    const std::int64_t high = row(lattice.cell_at(axis, box.upper[axis]) + 2);
    rows.first[a] += low;
    rows.counts[a] = high - low + 1;
  }
  return rows;
}

}  // namespace

bool is_closed_and_embedded(const TriangleMesh& mesh) {
  const Fans fans = fans_of(mesh);
  return fans.count_of_wrong() == 0 && degenerate_faces(mesh) == 0 && equal_vertices(mesh.vertices) == 0 &&
         !first_self_intersection(mesh, &fans.graphs);
}

std::vector<std::uint32_t> vertices_at_faults(const TriangleMesh& mesh) {
  const Fans fans = fans_of(mesh);
  std::vector<std::uint8_t> faulty = fans.wrong;
  equal_vertices(mesh.vertices, &faulty);
  const SelfIntersections found = self_intersections(mesh, SearchOrder::kRuns, &fans.graphs);
  for (std::size_t face = 0; face < mesh.triangles.size(); ++face) {
    if (!found.of_triangle[face] && !is_degenerate(mesh, face)) continue;
    for (const std::uint32_t corner : mesh.triangles[face]) faulty[corner] = 1;
  }
  return numbers_where(faulty.size(), [&](std::uint32_t v) { return faulty[v] != 0; });
}

NodeSet misplaced_nodes(const TriangleMesh& mesh, const NodeSet& inside, const std::vector<ExteriorEdge>* edges) {
  const WindingNumberEvaluator surface(mesh, {.edges = edges});
  NodeSet nodes = nodes_inside(surface, Rule{}, inside.lattice());
  nodes.flip(inside);
  return nodes;
}

SurfaceFaults faults_of(const TriangleMesh& mesh, const NodeSet& inside, NodeSet* misplaced) {
  SurfaceFaults faults;
  const Fans fans = fans_of(mesh);
  faults.links = fans.count_of_wrong();
  // An edge goes from a vertex to the next one around it in one face, and back in another: so where all vertices have
  // fans, all edges have their twins, and none is exterior.
  faults.edges = faults.links > 0 ? wrong_edges(mesh) : 0;
  const std::vector<ExteriorEdge> none;
  faults.degenerate_faces = degenerate_faces(mesh);
  faults.equal_vertices = equal_vertices(mesh.vertices);
  NodeSet nodes = misplaced_nodes(mesh, inside, faults.links > 0 ? nullptr : &none);
  faults.nodes = nodes.size();
  if (misplaced) *misplaced = std::move(nodes);
  faults.intersections = self_intersections(mesh, SearchOrder::kCurve, &fans.graphs);
  return faults;
}

NearFaults faults_near(const TriangleMesh& mesh, const SurfaceEdit& change, const Lattice& lattice) {
  const MeshPart part = part_near(mesh, change, lattice);
  const Fans fans = fans_of(part.mesh, &part.whole);
  std::vector<std::uint8_t> faulty = fans.wrong;
  NearFaults found;
  found.faults.links = fans.count_of_wrong();
  found.faults.equal_vertices = equal_vertices(part.mesh.vertices, &faulty);
  found.faults.intersections = self_intersections(part.mesh, SearchOrder::kCurve, &fans.graphs, &part.changed);
  SelfIntersections& of_part = found.faults.intersections;
  const std::vector<bool> meeting = std::exchange(of_part.of_triangle, std::vector<bool>(mesh.triangles.size(), false));
  if (of_part.first) of_part.first = {part.faces[(*of_part.first)[0]], part.faces[(*of_part.first)[1]]};
  for (std::size_t face = 0; face < part.faces.size(); ++face) {
    const bool degenerate = part.changed[face] != 0 && is_degenerate(part.mesh, face);
    found.faults.degenerate_faces += degenerate ? 1 : 0;
    if (meeting[face]) of_part.of_triangle[part.faces[face]] = true;
    if (!degenerate && !meeting[face]) continue;
    for (const std::uint32_t corner : part.mesh.triangles[face]) faulty[corner] = 1;
  }
  for (std::size_t v = 0; v < faulty.size(); ++v) {
    if (faulty[v] != 0) found.vertices.push_back(part.vertices[v]);
  }
  return found;
}

NodeSet changed_nodes(const TriangleMesh& mesh, const SurfaceEdit& change, const Lattice& lattice) {
  const std::vector<ExteriorEdge> none;
  TriangleMesh between = mesh_between(mesh, change);
  if (between.triangles.empty()) return NodeSet(lattice);
  const LatticeBlock rows = rows_at(bounding_box(between), lattice);
  const WindingNumberEvaluator evaluator(std::move(between), {.edges = &none});
  return nodes_inside_of(rows, evaluator, Rule{RuleKind::kOdd}, lattice);
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
