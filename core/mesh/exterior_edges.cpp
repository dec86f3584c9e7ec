#include "core/mesh/exterior_edges.h"

#include <emmintrin.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/machine/threads.h"
#include "core/mesh/edge_chains.h"

namespace raycone {
namespace {

// An edge traversed from its lower vertex to the higher one, or back.
struct Traversal {
  std::uint32_t low, high;
  std::int32_t direction;  // +1 from low to high, -1 back
};

// The corners of a triangle from its lowest one on.
struct FromLowest {
  std::uint32_t lowest = 0, next = 0, last = 0, middle = 0, highest = 0;

  FromLowest() = default;
  // By masks: branches on what the order of a mesh makes a coin toss are slow.
  explicit FromLowest(const Triangle& t) : lowest(VertexLinks::lowest_of(t)) {
    const auto mask = [](bool all) { return 0U - static_cast<std::uint32_t>(all); };
    const std::uint32_t first = mask(t[0] == lowest), second = ~first & mask(t[1] == lowest), third = ~(first | second);
    next = (t[1] & first) | (t[2] & second) | (t[0] & third);
    last = (t[2] & first) | (t[0] & second) | (t[1] & third);
    middle = VertexLinks::lower_of(next, last);
    highest = next ^ last ^ middle;
  }
  [[nodiscard]] bool is_collapsed() const { return (lowest == middle) | (middle == highest); }
};

// Lets traversals of one edge in opposite directions cancel each other, for edges whose lower vertex is in a range: in
// nearly all meshes they follow each other soon, so that few wait at a vertex at any time. Beside those that wait at a
// vertex are marks of the triangles that have it as their lowest one.
class Cancellation {
 public:
  Cancellation(std::size_t first_vertex, std::size_t last_vertex)
      : first_(first_vertex), waiting_(last_vertex - first_vertex) {}

  [[nodiscard]] bool has(std::uint32_t low) const { return low - first_ < waiting_.size(); }

  void prefetch(std::uint32_t low) const { _mm_prefetch(&waiting_[low - first_], _MM_HINT_T0); }

  // The two edges at the lowest corner, together: to the next one, and from the last one. Returns false where no
  // triangle with the same three corners was added before. Precondition: three different corners.
  bool add(const FromLowest& t) {
    Waiting& here = waiting_[t.lowest - first_];
    const std::uint64_t hash = t.middle * 0x9E3779B97F4A7C15U + t.highest * 0xD1B54A32D192ED03U;
    const std::uint32_t mark = mark_of(hash >> 54), other_mark = mark_of(hash >> 44);
    const bool marked = (~here.lanes[1][kMarks] & mark) == 0 && (~here.lanes[0][kMarks] & other_mark) == 0;
    const __m128i forward = load(here.lanes[1]), backward = load(here.lanes[0]);
    const __m128i next = _mm_set1_epi32(static_cast<int>(t.next)), last = _mm_set1_epi32(static_cast<int>(t.last));
    const unsigned next_meets = equal(backward, next), last_meets = equal(forward, last);
    const unsigned next_waits = place_to_wait(next_meets, forward), last_waits = place_to_wait(last_meets, backward);
    if ((next_meets | next_waits) == 0) crowd_.push_back({t.lowest, t.next, 1});
    if ((last_meets | last_waits) == 0) crowd_.push_back({t.lowest, t.last, -1});
    store(here.lanes[1], _mm_or_si128(with(without(forward, last_meets), next_waits, next), as_marks(mark)));
    store(here.lanes[0], _mm_or_si128(with(without(backward, next_meets), last_waits, last), as_marks(other_mark)));
    return marked;
  }

  void add(std::uint32_t low, std::uint32_t high, bool is_forward) {
    Waiting& here = waiting_[low - first_];
    Lanes &same = here.lanes[is_forward ? 1 : 0], &opposite = here.lanes[is_forward ? 0 : 1];
    const __m128i value = _mm_set1_epi32(static_cast<int>(high)), before = load(same), partners = load(opposite);
    const unsigned meets = equal(partners, value), waits = place_to_wait(meets, before);
    if ((meets | waits) == 0) return crowd_.push_back({low, high, is_forward ? 1 : -1});
    store(opposite, without(partners, meets));
    store(same, with(before, waits, value));
  }

  // What has not been cancelled, by increasing low, then high. Vertices with marks are noted as used.
  [[nodiscard]] std::vector<Traversal> rest(VertexLinks* links) {
    std::vector<Traversal> rest = std::move(crowd_);
    for (std::size_t i = 0; i < waiting_.size(); ++i) {
      const Waiting& here = waiting_[i];
      const auto low = static_cast<std::uint32_t>(first_ + i);
      if (links && here.lanes[1][kMarks] != 0) links->use(low);
      if (equal(_mm_or_si128(load(here.lanes[1]), load(here.lanes[0])), _mm_setzero_si128()) == kAllPlaces) continue;
      for (std::size_t place = 0; place < kMarks; ++place) {
        if (here.lanes[1][place] != kFree) rest.push_back({low, here.lanes[1][place], 1});
        if (here.lanes[0][place] != kFree) rest.push_back({low, here.lanes[0][place], -1});
      }
    }
    std::sort(rest.begin(), rest.end(), [](const Traversal& a, const Traversal& b) {
      return std::pair(a.low, a.high) < std::pair(b.low, b.high);
    });
    return rest;
  }

 private:
  static constexpr std::uint32_t kFree = 0;      // no vertex is lower than 0
  static constexpr std::size_t kMarks = 3;       // behind the places
  static constexpr unsigned kAllPlaces = 0b111;  // bit i: place i
  using Lanes = std::array<std::uint32_t, 4>;
  // Higher vertices, and marks: four bits of 64 tell a triangle from nearly all others of the same lowest vertex.
  struct alignas(32) Waiting {
    std::array<Lanes, 2> lanes{};
  };

  static __m128i load(const Lanes& lanes) { return _mm_load_si128(reinterpret_cast<const __m128i*>(lanes.data())); }
  // All four at once: soon they are loaded as four, which would wait for a smaller store.
  static void store(Lanes& lanes, __m128i values) { _mm_store_si128(reinterpret_cast<__m128i*>(lanes.data()), values); }
  static std::uint32_t mark_of(std::uint64_t hash) { return 1U << (hash & 31) | 1U << (hash >> 5 & 31); }
  static __m128i as_marks(std::uint32_t mark) { return _mm_slli_si128(_mm_cvtsi32_si128(static_cast<int>(mark)), 12); }

  // The places where they are equal.
  static unsigned equal(__m128i a, __m128i b) {
    return static_cast<unsigned>(_mm_movemask_ps(_mm_castsi128_ps(_mm_cmpeq_epi32(a, b)))) & kAllPlaces;
  }
  // The free places, none for what meets its partner.
  static unsigned place_to_wait(unsigned meets, __m128i same) {
    return equal(same, _mm_setzero_si128()) & (0U - static_cast<unsigned>(meets == 0));
  }
  // All bits of the first of some places.
  static __m128i first_of(unsigned places) {
    alignas(16) static constexpr std::array<Lanes, 8> kFirst{
        {{}, {~0U}, {0, ~0U}, {~0U}, {0, 0, ~0U}, {~0U}, {0, ~0U}, {~0U}}};
    return load(kFirst[places]);
  }
  static __m128i without(__m128i lanes, unsigned places) { return _mm_andnot_si128(first_of(places), lanes); }
  static __m128i with(__m128i lanes, unsigned places, __m128i value) {
    return _mm_or_si128(lanes, _mm_and_si128(first_of(places), value));
  }

  std::size_t first_;
  std::vector<Waiting> waiting_;
  std::vector<Traversal> crowd_;  // those that found no place
};

// Notes at `links` what joins the triangles of a range of lowest vertices.
class LinkNotes {
 public:
  explicit LinkNotes(VertexLinks* links) : links_(links) {}

  void note(const FromLowest& t, bool may_have_twin) {
    if (!links_) return;
    links_->join(t.lowest, t.next);
    links_->join(t.lowest, t.last);
    if (may_have_twin) twins_.push_back(t.lowest);
  }

  void note_collapsed(const FromLowest& t) {
    if (!links_) return;
    for (const std::uint32_t v : {t.lowest, t.next, t.last}) v == t.lowest ? links_->use(v) : links_->join(t.lowest, v);
  }

  [[nodiscard]] std::vector<std::uint32_t> take_twins() { return std::move(twins_); }

 private:
  VertexLinks* links_;
  std::vector<std::uint32_t> twins_;
};

// Of a range of vertices.
struct PartOfEdges {
  std::vector<ExteriorEdge> edges;   // by increasing low, then high
  std::vector<std::uint32_t> twins;  // for VertexLinks::add_twins()
};

std::vector<ExteriorEdge> net_counts(const std::vector<Traversal>& rest) {
  std::vector<ExteriorEdge> edges;
  for (auto it = rest.begin(); it != rest.end();) {
    ExteriorEdge edge{it->low, it->high, 0};
    for (; it != rest.end() && it->low == edge.from && it->high == edge.to; ++it) edge.multiplicity += it->direction;
    if (edge.multiplicity != 0) edges.push_back(edge);
  }
  return edges;
}

void add(const FromLowest& t, Cancellation& cancellation, LinkNotes& notes) {
  const bool is_here = cancellation.has(t.lowest);
  if (t.is_collapsed()) {  // what it adds to one direction it adds to the other
    if (is_here) notes.note_collapsed(t);
    return;
  }
  if (is_here) notes.note(t, cancellation.add(t));
  if (cancellation.has(t.middle)) cancellation.add(t.middle, t.highest, t.next < t.last);
}

// Net counts of the edges with their lower vertex in a range. If `links` are given, the triangles with their lowest
// vertex in that range are noted there.
PartOfEdges exterior_edges_of(const TriangleMesh& mesh, std::size_t first_vertex, std::size_t last_vertex,
                              VertexLinks* links) {
  Cancellation cancellation(first_vertex, last_vertex);
  LinkNotes notes(links);
  constexpr std::size_t kBlock = 32;  // triangles that are looked at ahead: their vertices may be anywhere in memory
  std::array<FromLowest, kBlock> block, next_block;
  const auto look_at = [&](std::size_t begin, std::array<FromLowest, kBlock>& triangles) {
    const std::size_t count = std::min(kBlock, mesh.triangles.size() - begin);
    for (std::size_t i = 0; i < count; ++i) {
      const FromLowest t(mesh.triangles[begin + i]);
      triangles[i] = t;
      if (cancellation.has(t.lowest)) cancellation.prefetch(t.lowest);
      if (cancellation.has(t.middle)) cancellation.prefetch(t.middle);
    }
    return count;
  };
  std::size_t count = look_at(0, block);
  for (std::size_t next = count; count > 0; next += count) {
    const std::size_t next_count = look_at(next, next_block);
    for (std::size_t i = 0; i < count; ++i) add(block[i], cancellation, notes);
    std::swap(block, next_block);
    count = next_count;
  }
  return {net_counts(cancellation.rest(links)), notes.take_twins()};
}

// By increasing low, then high. Each thread goes through all triangles, for a range of lower vertices.
std::vector<ExteriorEdge> unordered_exterior_edges(const TriangleMesh& mesh, VertexLinks* links) {
  constexpr std::size_t kMaxRanges = 8;  // more would only read the triangles more often
  const std::size_t ranges = std::min<std::size_t>(kMaxRanges, static_cast<std::size_t>(thread_count()));
  std::vector<PartOfEdges> parts(ranges);
  parallel_for_each(ranges, [&](std::size_t n) {
    const std::size_t vertices = mesh.vertices.size();
    parts[n] = exterior_edges_of(mesh, vertices * n / ranges, vertices * (n + 1) / ranges, links);
  });
  std::vector<ExteriorEdge> edges;
  for (const PartOfEdges& part : parts) {
    edges.insert(edges.end(), part.edges.begin(), part.edges.end());
    if (links) links->add_twins(part.twins);
  }
  return edges;
}

}  // namespace

std::vector<ExteriorEdge> exterior_edges(const TriangleMesh& mesh, VertexLinks* links) {
  return in_chains(mesh, unordered_exterior_edges(mesh, links));
}

}  // namespace raycone
