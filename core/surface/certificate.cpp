#include "core/surface/certificate.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <span>
#include <tuple>
#include <utility>

#include "core/exact/predicates.h"
#include "core/intersections/vertex_graph.h"
#include "core/machine/buckets.h"
#include "core/machine/threads.h"
#include "core/mesh/edge_uses.h"
#include "core/mesh/exterior_edges.h"
#include "core/mesh/vertex_faces.h"
#include "core/mesh/weld.h"

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

// Whether the faces around a vertex, each with the edge that faces it, make up one cycle.
// Sets `steps` to these edges.
bool is_fan(const TriangleMesh& mesh, std::uint32_t vertex, std::span<const std::uint32_t> faces,
            std::vector<FanStep>& steps) {
  steps.clear();
  for (const std::uint32_t face : faces) {
    const Triangle& t = mesh.triangles[face];
    const std::size_t at = t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2;
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

// What there is around each vertex.
struct Fans {
  std::uint64_t wrong = 0;  // vertices whose faces are no single fan
  std::vector<std::uint8_t>
      graphs;  // of each vertex whether these are one, and surely meet in nothing but what they share
};

Fans fans_of(const TriangleMesh& mesh) {
  const VertexFaces faces(mesh);
  Fans fans{0, std::vector<std::uint8_t>(mesh.vertices.size(), 0)};
  std::atomic<std::uint64_t> wrong = 0;
  parallel_for(mesh.vertices.size(), 1024, [&](std::size_t begin, std::size_t end) {
    std::vector<FanStep> steps;
    std::uint64_t here = 0;
    for (auto vertex = static_cast<std::uint32_t>(begin); vertex < end; ++vertex) {
      if (!is_fan(mesh, vertex, faces.of(vertex), steps)) {
        ++here;
      } else {
        fans.graphs[vertex] = is_surely_graph(mesh.vertices, vertex, steps) ? 1 : 0;
      }
    }
    wrong += here;
  });
  fans.wrong = wrong;
  return fans;
}

std::uint64_t degenerate_faces(const TriangleMesh& mesh) {
  return count_wrong(mesh.triangles.size(), [&](std::uint32_t face) {
    const Triangle& t = mesh.triangles[face];
    return collinear(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
  });
}

// The same for equal positions.
std::size_t hash_of(const Vec3& p) {
  std::uint64_t hash = 0;
  for (int axis = 0; axis < 3; ++axis) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(p[axis] + 0.0)) * 0x9E3779B97F4A7C15;  // -0 becomes 0
    hash ^= hash >> 32U;
  }
  return static_cast<std::size_t>(hash);
}

std::uint64_t equal_vertices(const TriangleMesh& mesh) {
  constexpr std::size_t kBuckets = 1024;
  const Buckets<Vec3> buckets(mesh.vertices.size(), kBuckets, [&](std::size_t begin, std::size_t end, auto emit) {
    for (std::size_t v = begin; v < end; ++v) emit(hash_of(mesh.vertices[v]) % kBuckets, mesh.vertices[v]);
  });
  std::atomic<std::uint64_t> equal = 0;
  parallel_for(kBuckets, 8, [&](std::size_t begin, std::size_t end) {
    std::uint64_t here = 0;
    for (std::size_t n = begin; n < end; ++n) {
      const std::span<Vec3> bucket = buckets[n];
      std::ranges::sort(bucket, {}, [](const Vec3& p) { return std::tuple(p.x, p.y, p.z); });
      for (std::size_t i = 1; i < bucket.size(); ++i) here += bucket[i] == bucket[i - 1] ? 1 : 0;
    }
    equal += here;
  });
  return equal;
}

}  // namespace

NodeSet misplaced_nodes(const TriangleMesh& mesh, const NodeSet& inside, const std::vector<ExteriorEdge>* edges) {
  const WindingNumberEvaluator surface(mesh, RayEngine::kScan, SimdLevel::kBest, Summation::kCheapest, edges);
  NodeSet nodes = nodes_inside(surface, Rule{}, inside.lattice());
  nodes.flip(inside);
  return nodes;
}

SurfaceFaults faults_of(const TriangleMesh& mesh, const NodeSet& inside) {
  SurfaceFaults faults;
  const Fans fans = fans_of(mesh);
  faults.links = fans.wrong;
  // An edge goes from a vertex to the next one around it in one face, and back in another: so where all vertices have
  // fans, all edges have their twins, and none is exterior.
  faults.edges = faults.links > 0 ? wrong_edges(mesh) : 0;
  const std::vector<ExteriorEdge> none;
  faults.degenerate_faces = degenerate_faces(mesh);
  faults.equal_vertices = equal_vertices(mesh);
  faults.nodes = misplaced_nodes(mesh, inside, faults.links > 0 ? nullptr : &none).size();
  faults.intersections = self_intersections(mesh, SearchOrder::kCurve, &fans.graphs);
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
