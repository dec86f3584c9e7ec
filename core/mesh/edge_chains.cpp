#include "core/mesh/edge_chains.h"

#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <numeric>
#include <span>

namespace raycone {
namespace {

// Vertices of edges, each once.
class EdgeVertices {
 public:
  EdgeVertices(const TriangleMesh& mesh, std::span<const ExteriorEdge> edges) {
    for (const ExteriorEdge& e : edges) {
      numbers_.push_back(e.from);
      numbers_.push_back(e.to);
    }
    std::ranges::sort(numbers_);
    numbers_.erase(std::unique(numbers_.begin(), numbers_.end()), numbers_.end());
    std::vector<Placed> placed(numbers_.size());
    for (std::uint32_t i = 0; i < placed.size(); ++i) placed[i] = {mesh.vertices[numbers_[i]].x, i};
    // By coordinates; indices tell apart only vertices that were left unwelded at one position.
    std::ranges::sort(placed, [&](const Placed& a, const Placed& b) {
      if (a.x < b.x || a.x > b.x) return a.x < b.x;  // mostly decided without looking the vertices up
      const auto order = lexicographic_order(mesh.vertices[numbers_[a.place]], mesh.vertices[numbers_[b.place]]);
      return order != 0 ? order < 0 : a.place < b.place;
    });
    ranks_.resize(placed.size());
    for (std::uint32_t rank = 0; rank < placed.size(); ++rank) ranks_[placed[rank].place] = rank;
  }

  [[nodiscard]] std::size_t size() const { return numbers_.size(); }

  // How many vertices are lexicographically smaller than this one.
  [[nodiscard]] std::uint32_t rank(std::uint32_t vertex) const {
    return ranks_[static_cast<std::size_t>(std::ranges::lower_bound(numbers_, vertex) - numbers_.begin())];
  }

 private:
  struct Placed {
    double x;
    std::uint32_t place;  // in numbers_
  };

  std::vector<std::uint32_t> numbers_;  // ascending
  std::vector<std::uint32_t> ranks_;    // of these
};

// Orders the edges of one |multiplicity| into chains, walking from the lexicographically smallest vertex with an unused
// edge along unused edges to the smallest neighbour, until stuck; and so on.
class Chains {
 public:
  Chains(const TriangleMesh& mesh, std::span<const ExteriorEdge> edges) : edges_(edges), used_(edges.size(), false) {
    const EdgeVertices vertices(mesh, edges);
    std::vector<std::uint32_t> counts(vertices.size(), 0);
    ends_.reserve(edges.size());
    for (const ExteriorEdge& e : edges) {
      const Ends& ends = ends_.emplace_back(Ends{vertices.rank(e.from), vertices.rank(e.to)});
      ++counts[ends.from];
      ++counts[ends.to];
    }
    first_.assign(counts.size() + 1, 0);
    std::inclusive_scan(counts.begin(), counts.end(), first_.begin() + 1, std::plus<>(), std::size_t{0});
    next_.assign(first_.begin(), first_.end() - 1);
    incidences_.resize(first_.back());
    for (std::size_t i = 0; i < edges.size(); ++i) {
      incidences_[next_[ends_[i].from]++] = {ends_[i].to, i};
      incidences_[next_[ends_[i].to]++] = {ends_[i].from, i};
    }
    for (std::size_t v = 0; v < counts.size(); ++v) {
      next_[v] = first_[v];
      std::ranges::sort(std::span(incidences_).subspan(first_[v], counts[v]));
    }
  }

  void append_to(std::vector<ExteriorEdge>& ordered) {
    for (std::uint32_t start = 0; start < next_.size(); ++start) {
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
    std::size_t& next = next_[vertex];
    while (next < first_[vertex + 1] && used_[incidences_[next].edge]) ++next;
    return next < first_[vertex + 1] ? &incidences_[next] : nullptr;
  }

  std::span<const ExteriorEdge> edges_;
  std::vector<Ends> ends_;  // of edges
  std::vector<bool> used_;  // likewise
  // Those of vertex v are [first_[v], first_[v + 1]); all before next_[v] are used.
  std::vector<Incidence> incidences_;
  std::vector<std::size_t> first_, next_;
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
