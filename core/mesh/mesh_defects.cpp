#include "core/mesh/mesh_defects.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <map>
#include <utility>

#include "core/exact/predicates.h"
#include "core/exact/scale.h"
#include "core/machine/floating_point.h"
#include "core/mesh/components.h"
#include "core/mesh/edge_uses.h"

namespace raycone {
namespace {

// Such an edge counts twice in the boundary, so that most meshes need no look at the others.
std::uint64_t count_inconsistent_edges(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges) {
  if (std::ranges::none_of(edges, [](const ExteriorEdge& e) { return std::abs(e.multiplicity) == 2; })) return 0;
  std::uint64_t count = 0;
  for_each_edge(mesh, [&count](const EdgeUse& use) {
    count += (use.forward == 2 && use.backward == 0) || (use.forward == 0 && use.backward == 2);
  });
  return count;
}

// A face by its vertices, and whether they are in increasing order but for a rotation.
struct FaceKey {
  std::array<std::uint32_t, 3> corners;
  bool increasing;
};

FaceKey key_of(const Triangle& t) {
  const auto low = static_cast<std::size_t>(std::min_element(t.begin(), t.end()) - t.begin());
  const std::uint32_t next = t[(low + 1) % 3], last = t[(low + 2) % 3];
  return {{t[low], std::min(next, last), std::max(next, last)}, next < last};
}

bool has_three_vertices(const Triangle& t) { return t[0] != t[1] && t[1] != t[2] && t[2] != t[0]; }

// Equal for faces of the same vertices, in whatever order.
std::uint64_t hash_of(const Triangle& t) {
  const auto mixed = [](std::uint64_t v) {
    v *= 0x9E3779B97F4A7C15;
    return v ^ (v >> 32);
  };
  return (mixed(t[0]) + mixed(t[1]) + mixed(t[2])) * 0x9E3779B97F4A7C15;
}

// The faces that may have a twin, and a few others: sorting all of them would take ten times as long.
std::vector<FaceKey> possible_twins(const TriangleMesh& mesh) {
  constexpr std::size_t kBitsPerFace = 16;
  const int shift = 64 - static_cast<int>(std::bit_width(kBitsPerFace * mesh.triangles.size()));
  std::vector<bool> seen(std::size_t{1} << (64 - shift)), seen_again(seen.size());
  for (const Triangle& t : mesh.triangles) {
    const std::size_t bit = hash_of(t) >> shift;
    if (seen[bit]) seen_again[bit] = true;
    seen[bit] = true;
  }
  std::vector<FaceKey> keys;
  for (const Triangle& t : mesh.triangles) {
    if (seen_again[hash_of(t) >> shift] && has_three_vertices(t)) keys.push_back(key_of(t));
  }
  return keys;
}

std::uint64_t count_cancelling_pairs(const TriangleMesh& mesh) {
  std::vector<FaceKey> keys = possible_twins(mesh);
  std::ranges::sort(keys, {}, &FaceKey::corners);
  std::uint64_t pairs = 0;
  for (auto it = keys.begin(); it != keys.end();) {
    std::array<std::uint64_t, 2> faces{};
    const auto first = it;
    for (; it != keys.end() && it->corners == first->corners; ++it) ++faces[it->increasing ? 1 : 0];
    pairs += std::min(faces[0], faces[1]);
  }
  return pairs;
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
  // Each product is off by a few units in the last place, each addition by one of the sum so far.
  [[nodiscard]] bool is_negative() const {
    const double rounding = (static_cast<double>(faces) + 16.0) * std::numeric_limits<double>::epsilon();
    return sum < -(rounding * terms + 0x1p-1000);
  }
};

// Of the tetrahedron of a face and a point near it.
Volume volume_of(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& from) {
  const Vec3 a = p - from, b = q - from, c = r - from;
  const double x1 = b.y * c.z, x2 = b.z * c.y, y1 = b.z * c.x, y2 = b.x * c.z, z1 = b.x * c.y, z2 = b.y * c.x;
  return {a.x * (x1 - x2) + a.y * (y1 - y2) + a.z * (z1 - z2),
          std::abs(a.x) * (std::abs(x1) + std::abs(x2)) + std::abs(a.y) * (std::abs(y1) + std::abs(y2)) +
              std::abs(a.z) * (std::abs(z1) + std::abs(z2)),
          1};
}

// The closed components of a mesh, and which of them are reversed.
class ClosedComponents {
 public:
  ClosedComponents(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges)
      : mesh_(mesh),
        scale_(-largest_exponent(mesh)),
        components_(components_of(mesh)),
        open_(components_.count, false) {
    for (const ExteriorEdge& edge : edges) open_[components_.of_vertex[edge.from]] = true;
    add_volumes();
  }

  [[nodiscard]] std::uint64_t count_reversed() const {
    std::vector<Candidate> candidates = negative_ones();
    if (components_.count > 1 && !candidates.empty()) drop_surrounded(candidates);
    return candidates.size();
  }

  [[nodiscard]] bool whole_is_negative() const {
    Volume whole;
    for (const Volume& volume : volumes_) whole += volume;
    return whole.is_negative();
  }

 private:
  // A component of negative volume, and its lexicographically first vertex. The perturbation (core/exact/predicates.h)
  // moves that towards the rest of the component, also where it touches a surface around it.
  struct Candidate {
    std::uint32_t component;
    Vec3 point;
  };

  [[nodiscard]] std::uint32_t component_of(const Triangle& t) const { return components_.of_vertex[t[0]]; }

  // Each from a vertex of its own: a component far from the origin keeps its digits.
  void add_volumes() {
    std::vector<Vec3> from(components_.count);
    std::vector<bool> begun(components_.count, false);
    volumes_.resize(components_.count);
    for (const Triangle& t : mesh_.triangles) {
      const std::uint32_t component = component_of(t);
      if (open_[component]) continue;
      const Vec3 a = scale_(mesh_.vertices[t[0]]);
      if (!begun[component]) from[component] = a;
      begun[component] = true;
      volumes_[component] += volume_of(a, scale_(mesh_.vertices[t[1]]), scale_(mesh_.vertices[t[2]]), from[component]);
    }
  }

  // By increasing y of their points.
  [[nodiscard]] std::vector<Candidate> negative_ones() const {
    constexpr std::uint32_t kAbsent = Components::kUnused;
    std::vector<std::uint32_t> number(components_.count, kAbsent);
    std::vector<Candidate> candidates;
    for (std::uint32_t c = 0; c < components_.count; ++c) {
      if (!volumes_[c].is_negative()) continue;
      number[c] = static_cast<std::uint32_t>(candidates.size());
      constexpr double kInfinity = std::numeric_limits<double>::infinity();
      candidates.push_back({c, {kInfinity, kInfinity, kInfinity}});
    }
    if (candidates.empty()) return candidates;
    for (const Triangle& t : mesh_.triangles) {
      const std::uint32_t n = number[component_of(t)];
      if (n == kAbsent) continue;
      for (const std::uint32_t v : t) {
        Vec3& least = candidates[n].point;
        if (lexicographic_order(mesh_.vertices[v], least) < 0) least = mesh_.vertices[v];
      }
    }
    std::ranges::sort(candidates, {}, [](const Candidate& candidate) { return candidate.point.y; });
    return candidates;
  }

  // +1 or -1 where the ray from q along +x crosses the triangle, by the sign of its normal's x.
  [[nodiscard]] int crossing(const Triangle& t, const Vec3& q) const {
    const Vec3 &a = mesh_.vertices[t[0]], &b = mesh_.vertices[t[1]], &c = mesh_.vertices[t[2]];
    const int side = edge_side(a, b, q).sign;
    if (side == 0 || edge_side(b, c, q).sign != side || edge_side(c, a, q).sign != side) return 0;
    return plane_side(a, b, c, q) * side < 0 ? side : 0;
  }

  // Removes those that lie in another closed component: whose winding number at their point is not 0.
  void drop_surrounded(std::vector<Candidate>& candidates) const {
    std::map<std::pair<std::size_t, std::uint32_t>, std::int64_t> crossings;  // of candidate and other component
    for (const Triangle& t : mesh_.triangles) {
      const std::uint32_t component = component_of(t);
      if (open_[component]) continue;
      const auto [first, last] = std::minmax({mesh_.vertices[t[0]].y, mesh_.vertices[t[1]].y, mesh_.vertices[t[2]].y});
      const auto y = [](const Candidate& candidate) { return candidate.point.y; };
      const auto begin = std::ranges::lower_bound(candidates, first, {}, y);
      for (auto it = begin; it != candidates.end() && it->point.y <= last; ++it) {
        if (it->component == component) continue;
        if (const int sign = crossing(t, it->point)) {
          crossings[{static_cast<std::size_t>(it - candidates.begin()), component}] += sign;
        }
      }
    }
    std::vector<bool> surrounded(candidates.size(), false);
    for (const auto& [pair, sum] : crossings) {
      if (sum != 0) surrounded[pair.first] = true;
    }
    std::vector<Candidate> outermost;
    for (std::size_t n = 0; n < candidates.size(); ++n) {
      if (!surrounded[n]) outermost.push_back(candidates[n]);
    }
    candidates = std::move(outermost);
  }

  const TriangleMesh& mesh_;
  PowerOfTwo scale_;
  Components components_;
  std::vector<bool> open_;
  std::vector<Volume> volumes_;
};

}  // namespace

MeshDefects mesh_defects(const TriangleMesh& welded, const std::vector<ExteriorEdge>& edges) {
  if (welded.triangles.empty()) return {};
  const DefaultFloatingPoint guard;
  MeshDefects defects;
  defects.inconsistent_edges = count_inconsistent_edges(welded, edges);
  defects.cancelling_pairs = count_cancelling_pairs(welded);
  const ClosedComponents closed(welded, edges);
  defects.reversed_components = closed.count_reversed();
  defects.negative_volume = edges.empty() && closed.whole_is_negative();
  return defects;
}

}  // namespace raycone
