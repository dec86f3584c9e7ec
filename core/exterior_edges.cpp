#include "core/exterior_edges.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>

namespace raycone {
namespace {

// One traversal of an edge as its higher vertex and a direction, filed under its lower vertex.
struct Traversal {
  std::uint32_t high;
  bool forward;
};

// Where the traversals of each lower vertex begin, and all of them, grouped (a counting sort).
struct TraversalTable {
  std::vector<std::size_t> begin;  // per vertex, and the end
  std::vector<Traversal> traversals;
};

template <class Visit>
void for_each_traversal(const TriangleMesh& mesh, const Visit& visit) {
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t from = t[corner], to = t[(corner + 1) % 3];
      if (from != to) visit(std::min(from, to), Traversal{std::max(from, to), from < to});
    }
  }
}

TraversalTable traversal_table(const TriangleMesh& mesh) {
  TraversalTable table;
  table.begin.assign(mesh.vertices.size() + 2, 0);
  for_each_traversal(mesh, [&](std::uint32_t low, const Traversal&) { ++table.begin[low + 2]; });
  std::partial_sum(table.begin.begin(), table.begin.end(), table.begin.begin());
  table.traversals.resize(table.begin.back());
  // begin[v + 1] is the next free place of vertex v, and its end when all are filled.
  for_each_traversal(mesh,
                     [&](std::uint32_t low, const Traversal& t) { table.traversals[table.begin[low + 1]++] = t; });
  return table;
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
  TraversalTable table = traversal_table(mesh);
  for (std::uint32_t low = 0; low < mesh.vertices.size(); ++low) {
    const auto begin = table.traversals.begin() + static_cast<std::ptrdiff_t>(table.begin[low]);
    const auto end = table.traversals.begin() + static_cast<std::ptrdiff_t>(table.begin[low + 1]);
    std::sort(begin, end, [](const Traversal& a, const Traversal& b) { return a.high < b.high; });
    for (auto it = begin; it != end;) {
      EdgeUse use{low, it->high, 0, 0};
      for (; it != end && it->high == use.high; ++it) ++(it->forward ? use.forward : use.backward);
      visit(use);
    }
  }
}

std::vector<ExteriorEdge> exterior_edges(const TriangleMesh& mesh) {
  std::vector<ExteriorEdge> edges;
  for_each_edge(mesh, [&](const EdgeUse& use) {
    const std::int32_t net = static_cast<std::int32_t>(use.forward - use.backward);
    if (net != 0) edges.push_back({use.low, use.high, net});
  });
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
