#include "core/mesh/exterior_edges.h"

#include <emmintrin.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <utility>

#include "core/machine/threads.h"

namespace raycone {
namespace {

// An edge traversed from its lower vertex to the higher one, or back.
struct Traversal {
  std::uint32_t low, high;
  std::int32_t direction;  // +1 from low to high, -1 back
};

// Lets traversals of one edge in opposite directions cancel each other, for edges whose lower vertex is in a range: in
// nearly all meshes they follow each other soon, so that few wait at a vertex at any time.
class Cancellation {
 public:
  Cancellation(std::size_t first_vertex, std::size_t last_vertex)
      : first_(first_vertex), waiting_(last_vertex - first_vertex) {}

  [[nodiscard]] bool has(std::uint32_t low) const { return low - first_ < waiting_.size(); }

  void prefetch(std::uint32_t low) const { _mm_prefetch(&waiting_[low - first_], _MM_HINT_T0); }

  // Without branches on what the order of a mesh makes a coin toss.
  void add(std::uint32_t low, std::uint32_t high, bool forward) {
    Waiting& here = waiting_[low - first_];
    const unsigned same = forward ? 1 : 0, opposite = 1 - same;
    const unsigned slots = equal(here.high[opposite], high) | equal(here.high[same], kFree) << 4;
    if (slots == 0) return crowd_.push_back({low, high, forward ? 1 : -1});
    const auto slot = static_cast<unsigned>(std::countr_zero(slots));
    const unsigned waits = slot >> 2;  // 0: cancels its partner
    put(here.high[opposite ^ waits], slot & 3, high * waits);
  }

  // What has not been cancelled, by increasing low, then high.
  [[nodiscard]] std::vector<Traversal> rest() {
    std::vector<Traversal> rest = std::move(crowd_);
    for (std::size_t i = 0; i < waiting_.size(); ++i) {
      for (const bool forward : {false, true}) {
        for (const std::uint32_t high : waiting_[i].high[forward ? 1 : 0]) {
          if (high != kFree) rest.push_back({static_cast<std::uint32_t>(first_ + i), high, forward ? 1 : -1});
        }
      }
    }
    std::sort(rest.begin(), rest.end(), [](const Traversal& a, const Traversal& b) {
      return std::pair(a.low, a.high) < std::pair(b.low, b.high);
    });
    return rest;
  }

 private:
  static constexpr std::uint32_t kFree = 0;  // no vertex is lower than 0
  struct alignas(32) Waiting {
    std::array<std::array<std::uint32_t, 4>, 2> high{};  // by direction
  };

  using Values = std::array<std::uint32_t, 4>;
  static __m128i load(const Values& values) { return _mm_load_si128(reinterpret_cast<const __m128i*>(values.data())); }

  // Bit i: values[i] == value.
  static unsigned equal(const Values& values, std::uint32_t value) {
    const __m128i same = _mm_cmpeq_epi32(load(values), _mm_set1_epi32(static_cast<int>(value)));
    return static_cast<unsigned>(_mm_movemask_ps(_mm_castsi128_ps(same)));
  }

  // values[i] = value, as one store of all four: soon they are loaded as four, which would wait for a smaller one.
  static void put(Values& values, unsigned i, std::uint32_t value) {
    alignas(16) static constexpr std::array<Values, 4> kSlot{
        {{~0U, 0, 0, 0}, {0, ~0U, 0, 0}, {0, 0, ~0U, 0}, {0, 0, 0, ~0U}}};
    const __m128i here = load(kSlot[i]);
    const __m128i all = _mm_or_si128(_mm_and_si128(here, _mm_set1_epi32(static_cast<int>(value))),
                                     _mm_andnot_si128(here, load(values)));
    _mm_store_si128(reinterpret_cast<__m128i*>(values.data()), all);
  }

  std::size_t first_;
  std::vector<Waiting> waiting_;
  std::vector<Traversal> crowd_;  // those that found no slot
};

template <class Visit>
void for_each_traversal(const Triangle& t, const Visit& visit) {
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const std::uint32_t from = t[corner], to = t[corner < 2 ? corner + 1 : 0];
    if (from != to) visit(std::min(from, to), std::max(from, to), from < to);
  }
}

// Net counts of the edges with their lower vertex in a range, by increasing low, then high. If `links` are given, the
// triangles with their lowest vertex in that range are noted there.
std::vector<ExteriorEdge> exterior_edges_of(const TriangleMesh& mesh, std::size_t first_vertex, std::size_t last_vertex,
                                            VertexLinks* links) {
  Cancellation cancellation(first_vertex, last_vertex);
  constexpr std::size_t kAhead = 16;  // triangles: their vertices may be anywhere in memory
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (i + kAhead < mesh.triangles.size()) {
      for_each_traversal(mesh.triangles[i + kAhead], [&](std::uint32_t low, std::uint32_t, bool) {
        if (cancellation.has(low)) cancellation.prefetch(low);
      });
      if (links) links->prefetch(VertexLinks::lowest_of(mesh.triangles[i + kAhead]));
    }
    if (links) {
      const std::uint32_t lowest = VertexLinks::lowest_of(mesh.triangles[i]);
      if (cancellation.has(lowest)) links->note(mesh.triangles[i], lowest);
    }
    for_each_traversal(mesh.triangles[i], [&](std::uint32_t low, std::uint32_t high, bool forward) {
      if (cancellation.has(low)) cancellation.add(low, high, forward);
    });
  }
  std::vector<ExteriorEdge> edges;
  const std::vector<Traversal> rest = cancellation.rest();
  for (auto it = rest.begin(); it != rest.end();) {
    ExteriorEdge edge{it->low, it->high, 0};
    for (; it != rest.end() && it->low == edge.from && it->high == edge.to; ++it) edge.multiplicity += it->direction;
    if (edge.multiplicity != 0) edges.push_back(edge);
  }
  return edges;
}

// By increasing low, then high. Each thread goes through all triangles, for a range of lower vertices.
std::vector<ExteriorEdge> unordered_exterior_edges(const TriangleMesh& mesh, VertexLinks* links) {
  constexpr std::size_t kMaxRanges = 8;  // more would only read the triangles more often
  const std::size_t ranges = std::min<std::size_t>(kMaxRanges, static_cast<std::size_t>(thread_count()));
  std::vector<std::vector<ExteriorEdge>> parts(ranges);
  parallel_for(ranges, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const std::size_t vertices = mesh.vertices.size();
      parts[n] = exterior_edges_of(mesh, vertices * n / ranges, vertices * (n + 1) / ranges, links);
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
    incidences_.resize(vertices_.size());
    next_.assign(vertices_.size(), 0);
    used_.assign(edges.size(), false);
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const std::size_t from = rank(edges[i].from), to = rank(edges[i].to);
      incidences_[from].push_back({to, i});
      incidences_[to].push_back({from, i});
    }
    for (auto& incidences : incidences_) std::sort(incidences.begin(), incidences.end());
  }

  void append_to(std::vector<ExteriorEdge>& ordered, const std::vector<ExteriorEdge>& edges) {
    for (std::size_t start = 0; start < vertices_.size(); ++start) {
      std::size_t here = start;
      while (const Incidence* next = unused_incidence(here)) {
        const ExteriorEdge& e = edges[next->edge];
        used_[next->edge] = true;
        const bool along = e.from == vertices_[here];
        ordered.push_back(along ? e : ExteriorEdge{e.to, e.from, -e.multiplicity});
        here = next->neighbour;
        if (!unused_incidence(here)) here = start;
      }
    }
  }

 private:
  struct Incidence {
    std::size_t neighbour;
    std::size_t edge;
    friend auto operator<=>(const Incidence&, const Incidence&) = default;
  };

  const Incidence* unused_incidence(std::size_t vertex) {
    std::size_t& next = next_[vertex];
    while (next < incidences_[vertex].size() && used_[incidences_[vertex][next].edge]) ++next;
    return next < incidences_[vertex].size() ? &incidences_[vertex][next] : nullptr;
  }

  std::vector<std::uint32_t> vertices_;  // by coordinates; the rest refers to indices in this order
  std::vector<std::vector<Incidence>> incidences_;
  std::vector<std::size_t> next_;
  std::vector<bool> used_;
};

}  // namespace

std::vector<ExteriorEdge> exterior_edges(const TriangleMesh& mesh, VertexLinks* links) {
  std::vector<ExteriorEdge> edges = unordered_exterior_edges(mesh, links);
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
