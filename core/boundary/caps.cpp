#include "core/boundary/caps.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <queue>
#include <span>
#include <tuple>
#include <utility>

namespace raycone {
namespace {

constexpr std::uint32_t kMostChoices = 64;  // edges of a vertex: of more, a walk takes any
constexpr std::uint32_t kNone = UINT32_MAX;

using Loop = std::vector<std::uint32_t>;  // vertices, the last joined to the first

// The edges as a graph on their ends, each as often as its multiplicity says.
class EdgeGraph {
 public:
  explicit EdgeGraph(std::span<const DirectedEdge> edges) {
    for (const DirectedEdge& e : edges) {
      vertices_.push_back(e.from);
      vertices_.push_back(e.to);
    }
    const auto before = [](const Vec3& a, const Vec3& b) { return lexicographic_order(a, b) < 0; };
    std::ranges::sort(vertices_, before);
    vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
    const auto index_of = [&](const Vec3& v) {
      return static_cast<std::uint32_t>(std::ranges::lower_bound(vertices_, v, before) - vertices_.begin());
    };
    first_.assign(vertices_.size() + 1, 0);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const DirectedEdge& e : edges)
      pairs.insert(pairs.end(), static_cast<std::size_t>(e.multiplicity), {index_of(e.from), index_of(e.to)});
    std::ranges::sort(pairs);
    for (const auto& [from, to] : pairs) {
      ++first_[from + 1];
      to_.push_back(to);
    }
    for (std::size_t v = 0; v < vertices_.size(); ++v) first_[v + 1] += first_[v];
    left_.assign(first_.begin() + 1, first_.end());
  }

  [[nodiscard]] const std::vector<Vec3>& vertices() const { return vertices_; }

  // Calls visit(loop) for all loops without a repeated vertex, as a walk finds them that turns back as sharply as it
  // can: cracks turn by 180 degrees at their ends. The walk uses the edges up: a second one would find none.
  template <class Visit>
  void take_loops(const Visit& visit) {
    std::vector<std::uint32_t> place(vertices_.size(), kNone);  // on the path
    Loop path;
    for (std::uint32_t start = 0; start < vertices_.size(); ++start) {
      while (left_[start] > first_[start]) {
        path.assign(1, start);
        place[start] = 0;
        while (!path.empty()) {
          const std::uint32_t next = take_next(path);
          if (next == kNone) break;  // not a boundary: cannot be
          if (place[next] == kNone) {
            place[next] = static_cast<std::uint32_t>(path.size());
            path.push_back(next);
            continue;
          }
          const Loop loop(path.begin() + place[next], path.end());
          for (const std::uint32_t v : loop) place[v] = kNone;
          path.resize(path.size() - loop.size());
          visit(loop);
          if (path.empty()) break;
          place[next] = static_cast<std::uint32_t>(path.size());
          path.push_back(next);
        }
        for (const std::uint32_t v : path) place[v] = kNone;
      }
    }
  }

 private:
  std::uint32_t take_next(const Loop& path) {
    const std::uint32_t v = path.back();
    if (left_[v] == first_[v]) return kNone;
    std::size_t best = left_[v] - 1;
    if (path.size() > 1 && left_[v] - first_[v] <= kMostChoices) {
      const Vec3 back = vertices_[path[path.size() - 2]] - vertices_[v];
      double best_cosine = -2.0;
      for (std::size_t e = first_[v]; e < left_[v]; ++e) {
        const Vec3 out = vertices_[to_[e]] - vertices_[v];
        const double cosine = dot(out, back) / (norm(out) * norm(back));
        if (cosine > best_cosine) best_cosine = cosine, best = e;
      }
    }
    std::swap(to_[best], to_[--left_[v]]);
    return to_[left_[v]];
  }

  std::vector<Vec3> vertices_;
  // Edges of v to to_[first_[v]] ... to_[left_[v] - 1] are still there, each as often as its multiplicity says.
  std::vector<std::size_t> first_, left_;
  std::vector<std::uint32_t> to_;
};

class LoopFiller {
 public:
  explicit LoopFiller(const std::vector<Vec3>& vertices) : vertices_(vertices) {}

  struct Filling {
    std::vector<Triangle> triangles;
    double area = 0.0;
  };

  // Ears are cut off, the one with the shortest diagonal first. So the loop gets coarser, round by round, until its
  // edges are as long as it is wide: few triangles are large, and a crack or a ribbon takes little more than its area.
  // Empty for an edge there and back.
  [[nodiscard]] Filling fill(const Loop& loop) const {
    const auto n = static_cast<std::uint32_t>(loop.size());
    struct Ear {
      double length;
      std::uint32_t at, before, after;
      bool operator<(const Ear& other) const {
        return std::tie(length, at, before, after) > std::tie(other.length, other.at, other.before, other.after);
      }
    };
    std::vector<std::uint32_t> before(n), after(n);
    std::priority_queue<Ear> queue;
    const auto push = [&](std::uint32_t i) {
      const Vec3 diagonal = vertices_[loop[after[i]]] - vertices_[loop[before[i]]];
      queue.push({dot(diagonal, diagonal), i, before[i], after[i]});
    };
    for (std::uint32_t i = 0; i < n; ++i) {
      before[i] = (i + n - 1) % n;
      after[i] = (i + 1) % n;
    }
    for (std::uint32_t i = 0; i < n; ++i) push(i);
    Filling filling;
    while (filling.triangles.size() + 2 < n) {
      const Ear ear = queue.top();
      queue.pop();
      if (before[ear.at] != ear.before || after[ear.at] != ear.after) continue;  // a neighbour is gone since
      add(filling, loop[ear.before], loop[ear.at], loop[ear.after]);
      after[ear.before] = ear.after;
      before[ear.after] = ear.before;
      before[ear.at] = after[ear.at] = ear.at;
      push(ear.before);
      push(ear.after);
    }
    return filling;
  }

  // Between two loops that run opposite ways: from the two vertices of theirs that are next to each other, along the
  // one and back along the other, always over the shorter diagonal.
  [[nodiscard]] Filling strip(const Loop& loop, const Loop& other) const {
    const std::size_t n = loop.size(), m = other.size();
    const auto at = [&](std::size_t i) { return loop[i % n]; };
    const std::size_t start = nearest(other, vertices_[at(0)]);
    const auto back = [&](std::size_t j) { return other[(start + 2 * m - j) % m]; };
    const auto apart = [&](std::uint32_t a, std::uint32_t b) { return norm(vertices_[a] - vertices_[b]); };
    Filling filling;
    for (std::size_t i = 0, j = 0; i < n || j < m;) {
      if (j == m || (i < n && apart(at(i + 1), back(j)) <= apart(at(i), back(j + 1)))) {
        add(filling, at(i), at(i + 1), back(j));
        ++i;
      } else {
        add(filling, back(j + 1), back(j), at(i));
        ++j;
      }
    }
    return filling;
  }

  // Between the first vertex of a loop and another loop.
  [[nodiscard]] double gap(const Loop& loop, const Loop& other) const {
    const Vec3& p = vertices_[loop[0]];
    return norm(vertices_[other[nearest(other, p)]] - p);
  }

  [[nodiscard]] double length(const Loop& loop) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      sum += norm(vertices_[loop[(i + 1) % loop.size()]] - vertices_[loop[i]]);
    }
    return sum;
  }

 private:
  void add(Filling& filling, std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const Vec3 normal = cross(vertices_[b] - vertices_[a], vertices_[c] - vertices_[a]);
    filling.area += norm(normal) / 2;
    filling.triangles.push_back({a, b, c});
  }

  // The place of the vertex of a loop that is nearest to a point.
  [[nodiscard]] std::size_t nearest(const Loop& loop, const Vec3& p) const {
    const auto from = [&](std::uint32_t v) { return norm(vertices_[v] - p); };
    return static_cast<std::size_t>(std::ranges::min_element(loop, {}, from) - loop.begin());
  }

  const std::vector<Vec3>& vertices_;
};

// Loops, each with what fills it, or it and another one.
class FilledLoops {
 public:
  explicit FilledLoops(LoopFiller filler) : filler_(filler) {}

  void add(const Loop& loop) { loops_.push_back({loop, filler_.fill(loop)}); }

  // Two loops by a strip, where that has half of the area or less. Of many loops none: each pair may be looked at.
  void join() {
    constexpr std::size_t kMostLoops = 256;
    for (std::size_t n = 0; n < loops_.size() && loops_.size() <= kMostLoops; ++n) {
      for (std::size_t m = 0; m < n && !loops_[n].is_joined; ++m) {
        if (!loops_[m].is_joined) join(loops_[n], loops_[m]);
      }
    }
  }

  [[nodiscard]] TriangleMesh triangles() const {
    TriangleMesh mesh;
    for (const Filled& one : loops_)
      mesh.triangles.insert(mesh.triangles.end(), one.filling.triangles.begin(), one.filling.triangles.end());
    return mesh;
  }

 private:
  struct Filled {
    Loop loop;
    LoopFiller::Filling filling;
    bool is_joined = false;
  };

  void join(Filled& one, Filled& other) const {
    constexpr double kLess = 0.5;
    const double both = one.filling.area + other.filling.area;
    if (!(filler_.gap(one.loop, other.loop) * filler_.length(one.loop) < both)) return;  // about what a strip has
    LoopFiller::Filling strip = filler_.strip(one.loop, other.loop);
    if (!(strip.area < kLess * both)) return;
    one.filling = std::move(strip);
    other.filling = {};
    one.is_joined = other.is_joined = true;
  }

  LoopFiller filler_;
  std::vector<Filled> loops_;
};

}  // namespace

Caps make_caps(const Boundary& boundary, double width) {
  EdgeGraph graph(boundary.directed_edges());
  Caps caps;
  caps.mesh.vertices = graph.vertices();
  const LoopFiller filler(caps.mesh.vertices);
  std::vector<Triangle> wide;
  graph.take_loops([&](const Loop& loop) {
    const auto [triangles, area] = filler.fill(loop);
    const bool narrow = area <= width * filler.length(loop) / 2;
    std::vector<Triangle>& all = narrow ? caps.mesh.triangles : wide;
    all.insert(all.end(), triangles.begin(), triangles.end());
    for (std::size_t i = 0; !narrow && i < loop.size(); ++i) {
      caps.wide_loops.push_back({caps.mesh.vertices[loop[i]], caps.mesh.vertices[loop[(i + 1) % loop.size()]], 1});
    }
  });
  caps.narrow = caps.mesh.triangles.size();
  caps.mesh.triangles.insert(caps.mesh.triangles.end(), wide.begin(), wide.end());
  return caps;
}

TriangleMesh caps_and_strips(const Boundary& boundary) {
  EdgeGraph graph(boundary.directed_edges());
  FilledLoops filled{LoopFiller(graph.vertices())};
  graph.take_loops([&](const Loop& loop) { filled.add(loop); });
  filled.join();
  TriangleMesh caps = filled.triangles();
  caps.vertices = graph.vertices();
  return caps;
}

}  // namespace raycone
