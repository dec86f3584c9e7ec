#include "core/boundary/caps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

namespace raycone {
namespace {

constexpr std::uint32_t kMostChoices = 64;  // edges of a vertex: of more, a walk takes any
constexpr std::uint32_t kNone = UINT32_MAX;

using Loop = std::vector<std::uint32_t>;  // vertices, the last joined to the first

double length_of(const Vec3& v) { return std::sqrt(dot(v, v)); }

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

  // All loops without a repeated vertex, as a walk finds them that turns back as sharply as it can: cracks turn by 180
  // degrees at their ends.
  template <class Visit>
  void for_each_loop(const Visit& visit) {
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
    std::uint32_t best = left_[v] - 1;
    if (path.size() > 1 && left_[v] - first_[v] <= kMostChoices) {
      const Vec3 back = vertices_[path[path.size() - 2]] - vertices_[v];
      double best_cosine = -2.0;
      for (std::uint32_t e = first_[v]; e < left_[v]; ++e) {
        const Vec3 out = vertices_[to_[e]] - vertices_[v];
        const double cosine = dot(out, back) / (length_of(out) * length_of(back));
        if (cosine > best_cosine) best_cosine = cosine, best = e;
      }
    }
    std::swap(to_[best], to_[--left_[v]]);
    return to_[left_[v]];
  }

  std::vector<Vec3> vertices_;
  std::vector<std::uint32_t> first_, left_, to_;  // edges of v to to_[first_[v]] ... to_[left_[v]-1] are still there
};

class LoopFiller {
 public:
  explicit LoopFiller(const std::vector<Vec3>& vertices) : vertices_(vertices) {}

  struct Filling {
    std::vector<Triangle> triangles;
    double area = std::numeric_limits<double>::infinity();
  };

  // The one of least area that is found. Empty for an edge there and back.
  [[nodiscard]] Filling fill(const Loop& loop) const {
    if (loop.size() < 3) return {{}, 0.0};
    Filling best;
    for (const std::size_t start : sharpest(loop)) {
      Filling filling = band(loop, start);
      if (filling.area < best.area || best.triangles.empty()) best = std::move(filling);
    }
    return best;
  }

  // A triangle of both ends and the middle, likewise for both halves.
  [[nodiscard]] Filling halved(const Loop& loop) const {
    Filling filling{{}, 0.0};
    std::vector<std::pair<std::size_t, std::size_t>> ranges{{0, loop.size() - 1}};
    while (!ranges.empty()) {
      const auto [first, last] = ranges.back();
      ranges.pop_back();
      if (last - first < 2) continue;
      const std::size_t half = first + (last - first) / 2;
      add(filling, loop[first], loop[half], loop[last]);
      ranges.emplace_back(first, half);
      ranges.emplace_back(half, last);
    }
    return filling;
  }

  [[nodiscard]] double length(const Loop& loop) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      sum += length_of(vertices_[loop[(i + 1) % loop.size()]] - vertices_[loop[i]]);
    }
    return sum;
  }

 private:
  void add(Filling& filling, std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const Vec3 normal = cross(vertices_[b] - vertices_[a], vertices_[c] - vertices_[a]);
    filling.area += length_of(normal) / 2;
    filling.triangles.push_back({a, b, c});
  }

  // Triangles that fill the loop as a band that begins at one of its vertices and takes the nearer neighbour on either
  // side each time: of a crack, begun at its end, that is nearly the least area there is.
  [[nodiscard]] Filling band(const Loop& loop, std::size_t start) const {
    Filling filling{{}, 0.0};
    const std::size_t n = loop.size();
    std::size_t up = start + 1, down = start + n - 1;  // modulo n
    const auto at = [&](std::size_t i) { return loop[i % n]; };
    add(filling, at(start), at(up), at(down));
    while (down - up > 1) {
      const Vec3 &u = vertices_[at(up)], &d = vertices_[at(down)];
      if (length_of(vertices_[at(up + 1)] - d) < length_of(vertices_[at(down - 1)] - u)) {
        add(filling, at(up), at(up + 1), at(down));
        ++up;
      } else {
        add(filling, at(up), at(down - 1), at(down));
        --down;
      }
    }
    return filling;
  }

  // The vertices at which the loop turns by most.
  [[nodiscard]] std::vector<std::size_t> sharpest(const Loop& loop) const {
    constexpr std::size_t kTried = 4;
    std::vector<std::pair<double, std::size_t>> corners;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec3& v = vertices_[loop[i]];
      const Vec3 back = vertices_[loop[(i + loop.size() - 1) % loop.size()]] - v;
      const Vec3 out = vertices_[loop[(i + 1) % loop.size()]] - v;
      corners.emplace_back(-dot(back, out) / (length_of(back) * length_of(out)), i);
    }
    const std::size_t count = std::min(kTried, corners.size());
    std::ranges::partial_sort(corners, corners.begin() + static_cast<std::ptrdiff_t>(count));
    std::vector<std::size_t> starts;
    for (std::size_t i = 0; i < count; ++i) starts.push_back(corners[i].second);
    return starts;
  }

  const std::vector<Vec3>& vertices_;
};

}  // namespace

Caps make_caps(const Boundary& boundary, double width) {
  EdgeGraph graph(boundary.directed_edges());
  Caps caps;
  caps.mesh.vertices = graph.vertices();
  const LoopFiller filler(caps.mesh.vertices);
  std::vector<Triangle> wide;
  graph.for_each_loop([&](const Loop& loop) {
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

TriangleMesh halved_caps(const Boundary& boundary) {
  constexpr double kMuchLess = 0.5;  // large caps are near to many samples
  EdgeGraph graph(boundary.directed_edges());
  TriangleMesh caps;
  caps.vertices = graph.vertices();
  const LoopFiller filler(caps.vertices);
  graph.for_each_loop([&](const Loop& loop) {
    if (loop.size() < 3) return;
    const LoopFiller::Filling halves = filler.halved(loop), band = filler.fill(loop);
    const auto& triangles = band.area < kMuchLess * halves.area ? band.triangles : halves.triangles;
    caps.triangles.insert(caps.triangles.end(), triangles.begin(), triangles.end());
  });
  return caps;
}

}  // namespace raycone
