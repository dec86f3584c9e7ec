#include "core/mesh/edge_chains.h"

#include <algorithm>
#include <bit>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "core/machine/sorted_by_key.h"

namespace raycone {
namespace {

// Some of the numbers below a limit: a bit for each number, and how many there are before each word of bits.
class NumberSet {
 public:
  explicit NumberSet(std::size_t limit) : bits_(limit / kBits + 1, 0) {}

  void add(std::uint32_t number) { bits_[number / kBits] |= std::uint64_t{1} << number % kBits; }

  // All of them, ascending. No more are added then.
  [[nodiscard]] std::vector<std::uint32_t> finish() {
    std::vector<std::uint32_t> numbers;
    before_.reserve(bits_.size());
    for (std::size_t word = 0; word < bits_.size(); ++word) {
      before_.push_back(static_cast<std::uint32_t>(numbers.size()));
      for (std::uint64_t bits = bits_[word]; bits != 0; bits &= bits - 1) {
        numbers.push_back(static_cast<std::uint32_t>(word * kBits + static_cast<std::size_t>(std::countr_zero(bits))));
      }
    }
    return numbers;
  }

  // How many of them are less than `number`, once finished.
  [[nodiscard]] std::uint32_t place(std::uint32_t number) const {
    const std::uint64_t less = bits_[number / kBits] & ((std::uint64_t{1} << number % kBits) - 1);
    return before_[number / kBits] + static_cast<std::uint32_t>(std::popcount(less));
  }

 private:
  static constexpr std::size_t kBits = 64;

  std::vector<std::uint64_t> bits_;
  std::vector<std::uint32_t> before_;
};

// Vertices of edges, each once.
class EdgeVertices {
 public:
  EdgeVertices(const TriangleMesh& mesh, std::span<const ExteriorEdge> edges) : vertices_(mesh.vertices.size()) {
    for (const ExteriorEdge& e : edges) {
      vertices_.add(e.from);
      vertices_.add(e.to);
    }
    std::vector<Placed> placed;
    for (const std::uint32_t v : vertices_.finish()) placed.push_back({mesh.vertices[v].x, v});
    // By coordinates; indices tell apart only vertices that were left unwelded at one position.
    std::ranges::sort(placed, [&](const Placed& a, const Placed& b) {
      if (a.x < b.x || a.x > b.x) return a.x < b.x;  // mostly decided without looking the vertices up
      const auto order = lexicographic_order(mesh.vertices[a.vertex], mesh.vertices[b.vertex]);
      return order != 0 ? order < 0 : a.vertex < b.vertex;
    });
    ranks_.resize(placed.size());
    for (std::uint32_t rank = 0; rank < placed.size(); ++rank) ranks_[vertices_.place(placed[rank].vertex)] = rank;
  }

  [[nodiscard]] std::size_t size() const { return ranks_.size(); }

  // How many vertices are lexicographically smaller than this one.
  [[nodiscard]] std::uint32_t rank(std::uint32_t vertex) const { return ranks_[vertices_.place(vertex)]; }

 private:
  struct Placed {
    double x;
    std::uint32_t vertex;
  };

  NumberSet vertices_;
  std::vector<std::uint32_t> ranks_;  // of each, by its place
};

// Orders the edges of one |multiplicity| into chains, walking from the lexicographically smallest vertex with an unused
// edge along unused edges to the smallest neighbour, until stuck; and so on.
class Chains {
 public:
  Chains(const TriangleMesh& mesh, std::span<const ExteriorEdge> edges) : edges_(edges), used_(edges.size(), false) {
    const EdgeVertices vertices(mesh, edges);
    ends_.reserve(edges.size());
    for (const ExteriorEdge& e : edges) ends_.push_back({vertices.rank(e.from), vertices.rank(e.to)});
    incidences_ = {vertices.size(), [&](const auto& emit) {
                     for (std::size_t i = 0; i < edges.size(); ++i) {
                       emit(ends_[i].from, Incidence{ends_[i].to, i});
                       emit(ends_[i].to, Incidence{ends_[i].from, i});
                     }
                   }};
    for (std::size_t v = 0; v < vertices.size(); ++v) std::ranges::sort(incidences_[v]);
    used_up_.assign(vertices.size(), 0);
  }

  void append_to(std::vector<ExteriorEdge>& ordered) {
    for (std::uint32_t start = 0; start < used_up_.size(); ++start) {
      std::uint32_t here = start;
      while (const Incidence* next = unused_incidence(here)) {
        const ExteriorEdge& e = edges_[next->edge];
        used_[next->edge] = true;
        const bool along = ends_[next->edge].from == here;
        ordered.push_back(along ? e : ExteriorEdge{e.to, e.from, -e.multiplicity});
        here = next->neighbour;
        if (!unused_incidence(here)) here = start;
      }
    }
  }

 private:
  // Vertices, by their rank.
  struct Ends {
    std::uint32_t from, to;
  };
  struct Incidence {
    std::uint32_t neighbour;
    std::size_t edge;
    friend auto operator<=>(const Incidence&, const Incidence&) = default;
  };

  const Incidence* unused_incidence(std::uint32_t vertex) {
    const std::span<const Incidence> all = incidences_[vertex];
    std::size_t& next = used_up_[vertex];
    while (next < all.size() && used_[all[next].edge]) ++next;
    return next < all.size() ? &all[next] : nullptr;
  }

  std::span<const ExteriorEdge> edges_;
  std::vector<Ends> ends_;             // of edges
  std::vector<bool> used_;             // likewise
  SortedByKey<Incidence> incidences_;  // by vertex; those of one in order
  std::vector<std::size_t> used_up_;   // of each vertex: so many of its incidences, from the first on, are used
};

}  // namespace

std::vector<ExteriorEdge> in_chains(const TriangleMesh& mesh, std::vector<ExteriorEdge> edges) {
  std::stable_sort(edges.begin(), edges.end(), [](const ExteriorEdge& a, const ExteriorEdge& b) {
    return std::abs(a.multiplicity) < std::abs(b.multiplicity);
  });
  std::vector<ExteriorEdge> ordered;
  ordered.reserve(edges.size());
  for (auto begin = edges.begin(); begin != edges.end();) {
    const auto end = std::find_if(begin, edges.end(), [&](const ExteriorEdge& e) {
      return std::abs(e.multiplicity) != std::abs(begin->multiplicity);
    });
    Chains(mesh, std::span(begin, end)).append_to(ordered);
    begin = end;
  }
  return ordered;
}

}  // namespace raycone
