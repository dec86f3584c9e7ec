#include "core/exterior_edges.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <numeric>
#include <span>

#include "core/buckets.h"
#include "core/threads.h"

namespace raycone {
namespace {

// Traversals of neighbouring lower vertices share a bucket, which fits a cache and is sorted there.
constexpr int kBucketLog2 = 12;
constexpr std::uint32_t kBucketMask = (1U << kBucketLog2) - 1;

// One traversal of an edge, filed in the bucket of its lower vertex. From the top: the lower vertex counted from the
// bucket's first, 32 bits for the higher one, one bit for low to high.
using Traversal = std::uint64_t;
constexpr int kLowShift = 33;

Traversal traversal(std::uint32_t low, std::uint32_t high, bool forward) {
  return Traversal{low & kBucketMask} << kLowShift | Traversal{high} << 1 | Traversal{forward};
}
std::uint32_t low_in_bucket(Traversal t) { return static_cast<std::uint32_t>(t >> kLowShift); }
std::uint32_t high(Traversal t) { return static_cast<std::uint32_t>(t >> 1); }
bool forward(Traversal t) { return (t & 1) != 0; }

Buckets<Traversal> traversals_of(const TriangleMesh& mesh) {
  const std::size_t count = (mesh.vertices.size() >> kBucketLog2) + 1;
  return {mesh.triangles.size(), count, [&](std::size_t begin, std::size_t end, auto emit) {
            for (std::size_t i = begin; i < end; ++i) {
              const Triangle& t = mesh.triangles[i];
              for (std::size_t corner = 0; corner < 3; ++corner) {
                const std::uint32_t from = t[corner], to = t[corner < 2 ? corner + 1 : 0];
                const std::uint32_t low = std::min(from, to);
                if (from != to) emit(low >> kBucketLog2, traversal(low, std::max(from, to), from < to));
              }
            }
          }};
}

// Few nearly always: six edges meet at a vertex of a large mesh.
void sort(std::span<Traversal> traversals) {
  constexpr std::size_t kFew = 24;
  if (traversals.size() > kFew) return std::sort(traversals.begin(), traversals.end());
  for (std::size_t i = 1; i < traversals.size(); ++i) {
    const Traversal t = traversals[i];
    std::size_t place = i;
    for (; place > 0 && traversals[place - 1] > t; --place) traversals[place] = traversals[place - 1];
    traversals[place] = t;
  }
}

// By lower vertex, then higher one: a counting sort, then one sort per lower vertex.
std::vector<Traversal> sorted(std::span<const Traversal> bucket) {
  std::array<std::uint32_t, kBucketMask + 3> begin{};
  for (const Traversal t : bucket) ++begin[low_in_bucket(t) + 2];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<Traversal> all(bucket.size());
  // begin[v + 1] is the next free place of vertex v, and its end when all are filled.
  for (const Traversal t : bucket) all[begin[low_in_bucket(t) + 1]++] = t;
  for (std::size_t v = 0; v <= kBucketMask; ++v) sort(std::span(all).subspan(begin[v], begin[v + 1] - begin[v]));
  return all;
}

// Calls visit for each edge whose traversals are in the bucket, by increasing low, then high.
template <class Visit>
void for_each_edge_in(std::span<const Traversal> bucket, std::uint32_t first_vertex, const Visit& visit) {
  const std::vector<Traversal> all = sorted(bucket);
  for (auto it = all.begin(); it != all.end();) {
    const Traversal edge = *it >> 1;
    EdgeUse use{first_vertex + low_in_bucket(*it), high(*it), 0, 0};
    for (; it != all.end() && *it >> 1 == edge; ++it) ++(forward(*it) ? use.forward : use.backward);
    visit(use);
  }
}

std::uint32_t first_vertex_of(std::size_t bucket) { return static_cast<std::uint32_t>(bucket << kBucketLog2); }

// By increasing low, then high.
std::vector<ExteriorEdge> unordered_exterior_edges(const TriangleMesh& mesh) {
  const Buckets<Traversal> buckets = traversals_of(mesh);
  std::vector<std::vector<ExteriorEdge>> parts(buckets.count());
  parallel_for(buckets.count(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      for_each_edge_in(buckets[n], first_vertex_of(n), [&](const EdgeUse& use) {
        const std::int32_t net = static_cast<std::int32_t>(use.forward - use.backward);
        if (net != 0) parts[n].push_back({use.low, use.high, net});
      });
    }
  });
  std::vector<ExteriorEdge> edges;
  for (const auto& part : parts) edges.insert(edges.end(), part.begin(), part.end());
  return edges;
}

// Orders the edges of one |multiplicity| into chains, walking from the lexicographically smallest vertex with an unused
// edge along unused edges to the smallest neighbour, until stuck; and so on.
class Chains {
 public:
  Chains(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges) {
    for (const ExteriorEdge& e : edges) {
      vertices_.push_back(e.from);
      vertices_.push_back(e.to);
    }
    // By coordinates; indices tell apart only vertices that were left unwelded at one position.
    const auto before = [&](std::uint32_t i, std::uint32_t j) {
      const auto order = lexicographic_order(mesh.vertices[i], mesh.vertices[j]);
      return order != 0 ? order < 0 : i < j;
    };
    std::sort(vertices_.begin(), vertices_.end(), before);
    vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
    const auto rank = [&](std::uint32_t v) {
      return static_cast<std::size_t>(std::lower_bound(vertices_.begin(), vertices_.end(), v, before) -
                                      vertices_.begin());
    };
    links_.resize(vertices_.size());
    next_.assign(vertices_.size(), 0);
    used_.assign(edges.size(), false);
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const std::size_t from = rank(edges[i].from), to = rank(edges[i].to);
      links_[from].push_back({to, i});
      links_[to].push_back({from, i});
    }
    for (auto& links : links_) std::sort(links.begin(), links.end());
  }

  void append_to(std::vector<ExteriorEdge>& ordered, const std::vector<ExteriorEdge>& edges) {
    for (std::size_t start = 0; start < vertices_.size(); ++start) {
      std::size_t here = start;
      while (const Link* link = unused_link(here)) {
        const ExteriorEdge& e = edges[link->edge];
        used_[link->edge] = true;
        const bool along = e.from == vertices_[here];
        ordered.push_back(along ? e : ExteriorEdge{e.to, e.from, -e.multiplicity});
        here = link->neighbour;
        if (!unused_link(here)) here = start;
      }
    }
  }

 private:
  struct Link {
    std::size_t neighbour;
    std::size_t edge;
    friend auto operator<=>(const Link&, const Link&) = default;
  };

  const Link* unused_link(std::size_t vertex) {
    std::size_t& next = next_[vertex];
    while (next < links_[vertex].size() && used_[links_[vertex][next].edge]) ++next;
    return next < links_[vertex].size() ? &links_[vertex][next] : nullptr;
  }

  std::vector<std::uint32_t> vertices_;  // by coordinates; the rest refers to places in this order
  std::vector<std::vector<Link>> links_;
  std::vector<std::size_t> next_;
  std::vector<bool> used_;
};

}  // namespace

void for_each_edge(const TriangleMesh& mesh, const std::function<void(const EdgeUse&)>& visit) {
  const Buckets<Traversal> buckets = traversals_of(mesh);
  for (std::size_t n = 0; n < buckets.count(); ++n) for_each_edge_in(buckets[n], first_vertex_of(n), visit);
}

std::vector<ExteriorEdge> exterior_edges(const TriangleMesh& mesh) {
  std::vector<ExteriorEdge> edges = unordered_exterior_edges(mesh);
  std::stable_sort(edges.begin(), edges.end(), [](const ExteriorEdge& a, const ExteriorEdge& b) {
    return std::abs(a.multiplicity) < std::abs(b.multiplicity);
  });
  std::vector<ExteriorEdge> ordered;
  ordered.reserve(edges.size());
  for (auto begin = edges.begin(); begin != edges.end();) {
    const auto end = std::find_if(begin, edges.end(), [&](const ExteriorEdge& e) {
      return std::abs(e.multiplicity) != std::abs(begin->multiplicity);
    });
    const std::vector<ExteriorEdge> group(begin, end);
    Chains(mesh, group).append_to(ordered, group);
    begin = end;
  }
  return ordered;
}

}  // namespace raycone
