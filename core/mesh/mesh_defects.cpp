#include "core/mesh/mesh_defects.h"

#include <emmintrin.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <span>
#include <utility>

#include "core/data/box.h"
#include "core/exact/predicates.h"
#include "core/exact/volume_sign.h"
#include "core/machine/floating_point.h"
#include "core/machine/threads.h"
#include "core/mesh/components.h"
#include "core/mesh/opposite_faces.h"
#include "core/mesh/ray_grid.h"

namespace raycone {
namespace {

// Such an edge counts twice in the boundary, so that most meshes need no look at their triangles.
std::uint64_t count_inconsistent_edges(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges) {
  struct DoubleEdge {
    std::uint32_t low, high;
    std::uint64_t uses = 0;
  };
  std::vector<DoubleEdge> doubles;
  for (const ExteriorEdge& e : edges) {
    if (std::abs(e.multiplicity) == 2) doubles.push_back({std::min(e.from, e.to), std::max(e.from, e.to)});
  }
  if (doubles.empty()) return 0;
  const auto ends = [](const DoubleEdge& e) { return std::pair(e.low, e.high); };
  std::ranges::sort(doubles, {}, ends);
  std::vector<bool> at_one(mesh.vertices.size(), false);
  for (const DoubleEdge& e : doubles) at_one[e.low] = at_one[e.high] = true;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t from = t[corner], to = t[corner < 2 ? corner + 1 : 0];
      if (!at_one[from] || !at_one[to]) continue;
      const auto edge = std::pair(std::min(from, to), std::max(from, to));
      const auto it = std::ranges::lower_bound(doubles, edge, {}, ends);
      if (it != doubles.end() && ends(*it) == edge) ++it->uses;
    }
  }
  return static_cast<std::uint64_t>(std::ranges::count(doubles, 2U, &DoubleEdge::uses));
}

// Six times a signed volume, and what rounding may have done to it.
struct Volume {
  double sum = 0.0;
  double terms = 0.0;  // sum of the absolute values of all products
  std::uint64_t faces = 0;

  Volume& operator+=(const Volume& other) {
    sum += other.sum;
    terms += other.terms;
    faces += other.faces;
    return *this;
  }
  [[nodiscard]] int sure_sign() const { return sure_volume_sign(sum, terms, faces); }
};

// Of the prism between a face and the plane x = from.x: the sum over a closed surface does not depend on the plane.
Volume volume_of(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& from) {
  const double x1 = a.x - from.x, x2 = b.x - from.x, x3 = c.x - from.x;
  // y and z together: this is most of what it costs to tell what is reversed
  const __m128d first = _mm_loadu_pd(&a.y), second = _mm_sub_pd(_mm_loadu_pd(&b.y), first),
                third = _mm_sub_pd(_mm_loadu_pd(&c.y), first);
  const __m128d products = _mm_mul_pd(second, _mm_shuffle_pd(third, third, 1));
  const double forth = _mm_cvtsd_f64(products), back = _mm_cvtsd_f64(_mm_unpackhi_pd(products, products));
  return {(x1 + x2 + x3) * (forth - back),
          (std::abs(x1) + std::abs(x2) + std::abs(x3)) * (std::abs(forth) + std::abs(back) + kVolumeUnderflow), 1};
}

// Of a closed mesh of one component, in any order: only its sure sign is used.
Volume volume_of(const TriangleMesh& mesh) {
  constexpr std::size_t kGrain = std::size_t{1} << 14;
  constexpr std::size_t kAhead = 16;  // triangles: their vertices may be anywhere in memory
  const Vec3 from = mesh.vertices[mesh.triangles.front()[0]];
  Volume whole;
  std::mutex adding;
  parallel_for(mesh.triangles.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    Volume part;
    for (std::size_t i = begin; i < end; ++i) {
      if (i + kAhead < end) {
        for (const std::uint32_t v : mesh.triangles[i + kAhead]) __builtin_prefetch(&mesh.vertices[v]);
      }
      const Triangle& t = mesh.triangles[i];
      part += volume_of(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]], from);
    }
    const std::lock_guard lock(adding);
    whole += part;
  });
  return whole;
}

// +1 or -1 where the ray from q along +x crosses the triangle, by the sign of its normal's x.
int crossing(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& q) {
  const int side = edge_side(a, b, q).sign;
  if (side == 0 || edge_side(b, c, q).sign != side || edge_side(c, a, q).sign != side) return 0;
  return plane_side(a, b, c, q) * side < 0 ? side : 0;
}

// Where a point lies with respect to a closed surface.
struct PointSum {
  std::int64_t winding = 0;  // at the perturbed point (core/exact/predicates.h)
  bool on_surface = false;   // on a closed triangle

  [[nodiscard]] bool is_none() const { return winding == 0 && !on_surface; }
};

// These of one closed surface after the other at the same points, but for those that are settled.
class PointSums {
 public:
  explicit PointSums(std::vector<Vec3> points)
      : points_(std::move(points)), grid_(points_), sums_(points_.size()), settled_(points_.size(), 0) {}
  PointSums(const PointSums&) = delete;
  PointSums& operator=(const PointSums&) = delete;

  // Calls visit(i) for each point in a box.
  template <class Visit>
  void for_each_in(const Box& box, const Visit& visit) const {
    grid_.for_each_ray(box.lower, box.upper, box.upper, box.lower.x, [&](std::size_t i) {  // as of a flat triangle
      if (settled_[i] == 0) visit(i);
    });
  }

  // Of a triangle of a surface that is at x and beyond: it is not around points before.
  void add(const Vec3& a, const Vec3& b, const Vec3& c, double x) {
    const double least_x = std::min({a.x, b.x, c.x});
    grid_.for_each_ray(a, b, c, x, [&](std::size_t i) {
      if (settled_[i] != 0) return;
      const Vec3& q = points_[i];
      const PointSum by{crossing(a, b, c, q), q.x >= least_x && on_triangle(a, b, c, q)};
      if (by.is_none()) return;
      if (sums_[i].is_none()) noted_.push_back(i);
      sums_[i].winding += by.winding;
      sums_[i].on_surface |= by.on_surface;
    });
  }

  // Ends a surface: calls visit(i, sum) for each point that is on it or at which its winding number is not 0, in any
  // order.
  template <class Visit>
  void take(const Visit& visit) {
    for (const std::size_t i : noted_) {
      if (const PointSum sum = std::exchange(sums_[i], {}); !sum.is_none()) visit(i, sum);
    }
    noted_.clear();
  }

  void settle(std::size_t i) {
    settled_[i] = 1;
    ++count_settled_;
  }
  [[nodiscard]] bool is_settled(std::size_t i) const { return settled_[i] != 0; }
  // So many that it is time to go on without them.
  [[nodiscard]] bool many_are_settled() const { return 4 * count_settled_ >= settled_.size(); }

 private:
  std::vector<Vec3> points_;
  RayGrid grid_;
  std::vector<PointSum> sums_;
  std::vector<std::size_t> noted_;  // all that have a sum, and some whose sum became none again
  std::vector<std::uint8_t> settled_;
  std::size_t count_settled_ = 0;
};

// A closed component.
struct ClosedComponent {
  std::uint32_t component;
  Box box;
  std::span<const std::uint32_t> faces;  // indices of triangles
};

// By decreasing size of their boxes, so that one is behind all that surround it.
class BySize {
 public:
  BySize(const TriangleMesh& mesh, const Components& components, const std::vector<bool>& open) {
    std::vector<Box> boxes(components.count, empty_box());
    begin_.assign(components.count + 1, 0);  // at first the numbers of faces
    const auto for_each_face = [&](const auto& visit) {
      for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const std::uint32_t component = components.of_vertex[mesh.triangles[i][0]];
        if (!open[component]) visit(i, component);
      }
    };
    for_each_face([&](std::uint32_t i, std::uint32_t component) {
      ++begin_[component];
      for (const std::uint32_t v : mesh.triangles[i]) extend(boxes[component], mesh.vertices[v]);
    });
    std::size_t total = 0;
    for (std::size_t& at : begin_) total += std::exchange(at, total);
    faces_.resize(total);
    std::vector<std::size_t> next = begin_;
    for_each_face([&](std::uint32_t i, std::uint32_t component) { faces_[next[component]++] = i; });
    for (std::uint32_t c = 0; c < components.count; ++c) {
      if (!open[c]) by_size_.push_back({c, boxes[c], faces_of(c)});
    }
    std::ranges::sort(by_size_, std::greater(), [](const ClosedComponent& s) { return size(s.box); });
  }
  BySize(const BySize&) = delete;
  BySize& operator=(const BySize&) = delete;

  // None of an open component.
  [[nodiscard]] std::span<const std::uint32_t> faces_of(std::uint32_t component) const {
    return {faces_.data() + begin_[component], faces_.data() + begin_[component + 1]};
  }

  [[nodiscard]] auto begin() const { return by_size_.begin(); }
  [[nodiscard]] auto end() const { return by_size_.end(); }

 private:
  // Of quarters, which do not overflow.
  static double size(const Box& box) {
    const Vec3 quarter = 0.25 * box.upper - 0.25 * box.lower;
    return quarter.x + quarter.y + quarter.z;
  }

  std::vector<std::uint32_t> faces_;  // by component
  std::vector<std::size_t> begin_;    // per component, and the end
  std::vector<ClosedComponent> by_size_;
};

// The closed components of a mesh, and which of them are reversed.
class ClosedComponents {
 public:
  // `opposite`: opposite_faces(mesh).
  ClosedComponents(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges, const Components& components,
                   const std::vector<std::uint32_t>& opposite)
      : mesh_(mesh), opposite_(opposite), components_(components), open_(components.count, false) {
    for (const ExteriorEdge& edge : edges) open_[components_.of_vertex[edge.from]] = true;
    if (std::ranges::count(open_, false) == 0) return;
    add_volumes();
    set_signs();
  }

  [[nodiscard]] std::uint64_t count_reversed() const {
    const auto negative = static_cast<std::uint64_t>(std::ranges::count(signs_, -1));
    if (negative == 0 || components_.count == 1) return negative;
    std::vector<Candidate> candidates = negative_ones();
    drop_surrounded(candidates);
    return candidates.size();
  }

  // Precondition: no component is open.
  [[nodiscard]] bool whole_is_negative() const {
    if (std::ranges::count(signs_, -1) == 0) return false;
    if (std::ranges::count(signs_, 1) == 0) return true;
    Volume whole;
    for (const Volume& volume : volumes_) whole += volume;
    if (const int sign = whole.sure_sign(); sign != 0) return sign < 0;
    return volume_sign(mesh_.triangles, mesh_.vertices) < 0;
  }

 private:
  // A component of negative volume, and its lexicographically first vertex. It lies within another component where the
  // first vertex does that is not on that one; where all are on it, where the perturbed first one does.
  struct Candidate {
    std::uint32_t component;
    Vec3 point;
  };

  [[nodiscard]] std::uint32_t component_of(const Triangle& t) const { return components_.of_vertex[t[0]]; }

  // Each from a vertex of its own: a component far from the origin keeps its digits.
  void add_volumes() {
    volumes_.resize(components_.count);
    if (components_.count == 1) {
      volumes_[0] = volume_of(mesh_);
      return;
    }
    std::vector<Vec3> from(components_.count);
    for (const Triangle& t : mesh_.triangles) {
      const std::uint32_t component = component_of(t);
      if (open_[component]) continue;
      const Vec3& a = mesh_.vertices[t[0]];
      Volume& volume = volumes_[component];
      if (volume.faces == 0) from[component] = a;
      volume += volume_of(a, mesh_.vertices[t[1]], mesh_.vertices[t[2]], from[component]);
    }
  }

  void set_signs() {
    signs_.assign(components_.count, 0);
    std::vector<bool> in_doubt(components_.count, false);
    for (std::uint32_t c = 0; c < components_.count; ++c) {
      signs_[c] = volumes_[c].sure_sign();
      in_doubt[c] = !open_[c] && signs_[c] == 0;
    }
    if (std::ranges::count(in_doubt, true) > 0) set_signs_exactly(in_doubt);
  }

  // Faces that cancel are left out: nearly all doubt is about double-sided surfaces, where they are all.
  void set_signs_exactly(const std::vector<bool>& in_doubt) {
    std::vector<std::pair<std::uint32_t, Triangle>> faces;  // with their components
    auto left_out = opposite_.begin();
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
      const std::uint32_t component = component_of(mesh_.triangles[i]);
      const bool cancels = left_out != opposite_.end() && *left_out == i;
      if (cancels) ++left_out;
      if (!cancels && in_doubt[component]) faces.emplace_back(component, mesh_.triangles[i]);
    }
    std::ranges::sort(faces);
    for (auto it = faces.begin(); it != faces.end();) {
      const std::uint32_t component = it->first;
      std::vector<Triangle> triangles;
      for (; it != faces.end() && it->first == component; ++it) triangles.push_back(it->second);
      signs_[component] = volume_sign(triangles, mesh_.vertices);
    }
  }

  [[nodiscard]] std::vector<Candidate> negative_ones() const {
    constexpr std::uint32_t kAbsent = Components::kUnused;
    std::vector<std::uint32_t> number(components_.count, kAbsent);
    std::vector<Candidate> candidates;
    for (std::uint32_t c = 0; c < components_.count; ++c) {
      if (signs_[c] >= 0) continue;
      number[c] = static_cast<std::uint32_t>(candidates.size());
      constexpr double kInfinity = std::numeric_limits<double>::infinity();
      candidates.push_back({c, {kInfinity, kInfinity, kInfinity}});
    }
    for (const Triangle& t : mesh_.triangles) {
      const std::uint32_t n = number[component_of(t)];
      if (n == kAbsent) continue;
      for (const std::uint32_t v : t) {
        Vec3& least = candidates[n].point;
        if (lexicographic_order(mesh_.vertices[v], least) < 0) least = mesh_.vertices[v];
      }
    }
    return candidates;
  }

  // Removes those that lie in another closed component, where its winding number is not 0. From the largest component
  // on, without those that are settled: of shells within each other, the outermost one settles all others.
  void drop_surrounded(std::vector<Candidate>& candidates) const {
    const BySize by_size(mesh_, components_, open_);
    std::optional<PointSums> sums(std::in_place, points_of(candidates));
    for (const ClosedComponent& outer : by_size) {
      if (sums->many_are_settled()) {
        drop_settled(candidates, *sums);
        if (candidates.empty()) return;
        sums.emplace(points_of(candidates));
      }
      std::vector<Touching> touching;
      for (const std::size_t i : settle_within(outer, candidates, *sums)) {
        touching.push_back({i, vertices_of(by_size.faces_of(candidates[i].component))});
      }
      settle_touching(outer, std::move(touching), *sums);
    }
    drop_settled(candidates, *sums);
  }

  static void drop_settled(std::vector<Candidate>& candidates, const PointSums& sums) {
    std::size_t i = 0;
    std::erase_if(candidates, [&](const Candidate&) { return sums.is_settled(i++); });
  }

  // Those whose first vertex lies in a component. Returns those of which it is on the component.
  std::vector<std::size_t> settle_within(const ClosedComponent& outer, const std::vector<Candidate>& candidates,
                                         PointSums& sums) const {
    const auto is_other = [&](std::size_t i) { return candidates[i].component != outer.component; };
    bool may_surround = false;
    sums.for_each_in(outer.box, [&](std::size_t i) { may_surround |= is_other(i); });
    if (!may_surround) return {};
    add_faces(sums, outer);
    std::vector<std::size_t> touching;
    sums.take([&](std::size_t i, const PointSum& sum) {
      if (!is_other(i)) return;
      if (sum.on_surface) return touching.push_back(i);
      sums.settle(i);
    });
    return touching;
  }

  // A candidate, and all its vertices in lexicographic order.
  struct Touching {
    std::size_t candidate;
    std::vector<Vec3> vertices;
  };

  // Few of the vertices are on the other component, nearly always: more and more are looked at.
  void settle_touching(const ClosedComponent& outer, std::vector<Touching> touching, PointSums& sums) const {
    for (std::size_t most = 4; !touching.empty(); most *= 4) {
      const auto looked_at = [most](const Touching& t) { return std::min(most, t.vertices.size()); };
      std::vector<Vec3> points;
      for (const Touching& t : touching) {
        points.insert(points.end(), t.vertices.begin(), t.vertices.begin() + static_cast<std::ptrdiff_t>(looked_at(t)));
      }
      const std::vector<PointSum> found = sums_at(std::move(points), outer);
      auto first = found.begin();
      std::erase_if(touching, [&](const Touching& t) {
        const auto end = first + static_cast<std::ptrdiff_t>(looked_at(t));
        const auto off = std::find_if(first, end, [](const PointSum& sum) { return !sum.on_surface; });
        const bool is_told = off != end || looked_at(t) == t.vertices.size();
        if (is_told && (off != end ? off : first)->winding != 0) sums.settle(t.candidate);
        first = end;
        return is_told;
      });
    }
  }

  [[nodiscard]] std::vector<PointSum> sums_at(std::vector<Vec3> points, const ClosedComponent& outer) const {
    std::vector<PointSum> found(points.size());
    PointSums sums(std::move(points));
    add_faces(sums, outer);
    sums.take([&](std::size_t i, const PointSum& sum) { found[i] = sum; });
    return found;
  }

  [[nodiscard]] std::vector<Vec3> vertices_of(std::span<const std::uint32_t> faces) const {
    std::vector<Vec3> vertices;
    for (const std::uint32_t i : faces) {
      for (const std::uint32_t v : mesh_.triangles[i]) vertices.push_back(mesh_.vertices[v]);
    }
    std::ranges::sort(vertices, [](const Vec3& a, const Vec3& b) { return lexicographic_order(a, b) < 0; });
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
  }

  static std::vector<Vec3> points_of(const std::vector<Candidate>& candidates) {
    std::vector<Vec3> points;
    for (const Candidate& candidate : candidates) points.push_back(candidate.point);
    return points;
  }

  void add_faces(PointSums& sums, const ClosedComponent& component) const {
    for (const std::uint32_t i : component.faces) {
      const Triangle& t = mesh_.triangles[i];
      sums.add(mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]], component.box.lower.x);
    }
  }

  const TriangleMesh& mesh_;
  const std::vector<std::uint32_t>& opposite_;
  const Components& components_;
  std::vector<bool> open_;
  std::vector<Volume> volumes_;
  std::vector<int> signs_;
};

}  // namespace

MeshDefects mesh_defects(const TriangleMesh& welded, const std::vector<ExteriorEdge>& edges, const VertexLinks& links) {
  if (welded.triangles.empty()) return {};
  const DefaultFloatingPoint guard;
  Components components;
  std::vector<std::uint32_t> opposite;
  parallel_for_each(2, [&](std::size_t n) {
    if (n == 0) components = components_of(welded, links);
    if (n == 1) opposite = opposite_faces(welded, links);
  });
  MeshDefects defects;
  defects.inconsistent_edges = count_inconsistent_edges(welded, edges);
  defects.cancelling_pairs = opposite.size() / 2;
  const ClosedComponents closed(welded, edges, components, opposite);
  defects.reversed_components = closed.count_reversed();
  defects.negative_volume = edges.empty() && closed.whole_is_negative();
  return defects;
}

}  // namespace raycone
