#include "core/surface/merge_planes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "core/mesh/vertex_faces.h"
#include "core/surface/edge_crossing.h"

namespace raycone {
namespace {

// A triangle's area over the square of its longest edge: 0.43 where it is regular. Pulls make none below this, unless
// there was one before.
constexpr double kLeastQuality = 1e-3;

struct FacePlane {
  Vec3 point, normal;

  [[nodiscard]] double distance(const Vec3& p) const { return std::abs(dot(normal, p - point)); }
};

// The mesh, while vertices are pulled into others.
class Merger {
 public:
  Merger(const SurfaceMesh& surface, const TriangleMesh& input, const std::vector<bool>& kept, double most,
         double needle)
      : surface_(surface),
        input_(input),
        most_(most),
        needle_(needle),
        state_(surface.mesh.vertices.size(), State::kWaits) {
    const VertexFaces faces(surface.mesh);
    star_.reserve(state_.size());
    for (std::uint32_t v = 0; v < state_.size(); ++v) {
      const auto star = faces.of(v);
      star_.emplace_back(star.begin(), star.end());
      into_.push_back(v);
      if (kept[v]) state_[v] = State::kKept;
    }
    for (std::uint32_t face = 0; face < surface_.mesh.triangles.size(); ++face) {
      planes_.push_back(plane_of(face));
      needles_.push_back(is_needle(face));
    }
  }

  // The points at each node first: while all of them are there, one is found that lies in all planes.
  MergedSurface merge() {
    pull_all(&Merger::target_at_node);
    for (State& state : state_) state = state == State::kStays ? State::kWaits : state;
    pull_all(&Merger::best_target);
    for (std::uint32_t& target : into_) {
      while (into_[target] != target) target = into_[target];
    }
    std::vector<Triangle> triangles;
    std::vector<std::int32_t> sources;
    for (std::size_t face = 0; face < planes_.size(); ++face) {
      if (is_gone(face)) continue;
      triangles.push_back(surface_.mesh.triangles[face]);
      sources.push_back(surface_.sources[face]);
    }
    surface_.mesh.triangles = std::move(triangles);
    surface_.sources = std::move(sources);
    return {std::move(surface_), std::move(into_)};
  }

 private:
  enum class State : std::uint8_t {
    kWaits,  // to be looked at
    kNext,   // in the next pass
    kStays,  // until something changes around it
    kKept,   // for ever
    kGone,
  };

  using Target = std::optional<std::uint32_t> (Merger::*)(std::uint32_t);

  // In each pass no vertex is pulled that a neighbour was pulled into, so that faces grow evenly.
  void pull_all(Target target_of) {
    for (bool pulled = true; pulled;) {
      pulled = false;
      for (std::uint32_t v = 0; v < state_.size(); ++v) {
        if (state_[v] != State::kWaits) continue;
        const std::optional<std::uint32_t> target = (this->*target_of)(v);
        state_[v] = target ? State::kGone : State::kStays;
        if (!target) continue;
        pull(v, *target);
        pulled = true;
      }
      for (State& state : state_) state = state == State::kNext ? State::kWaits : state;
    }
  }

  [[nodiscard]] const Vec3& position(std::uint32_t v) const { return surface_.mesh.vertices[v]; }
  [[nodiscard]] Triangle& triangle(std::uint32_t face) { return surface_.mesh.triangles[face]; }
  [[nodiscard]] const Triangle& triangle(std::uint32_t face) const { return surface_.mesh.triangles[face]; }
  [[nodiscard]] bool is_gone(std::size_t face) const {
    return surface_.mesh.triangles[face][0] == surface_.mesh.triangles[face][1];
  }
  [[nodiscard]] static bool has(const Triangle& t, std::uint32_t v) { return t[0] == v || t[1] == v || t[2] == v; }

  [[nodiscard]] FacePlane plane_of(std::uint32_t face) const {
    const Triangle& t = surface_.mesh.triangles[face];
    const Vec3 &a = position(t[0]), &b = position(t[1]), &c = position(t[2]);
    if (surface_.sources[face] != kHole) {
      const Triangle& source = input_.triangles[static_cast<std::size_t>(surface_.sources[face])];
      const Vec3 normal =
          unit_normal(input_.vertices[source[0]], input_.vertices[source[1]], input_.vertices[source[2]]);
      const Vec3 own = cross(b - a, c - a);
      const FacePlane plane{a, dot(normal, own) < 0.0 ? -1.0 * normal : normal};
      if (plane.distance(b) <= most_ && plane.distance(c) <= most_) return plane;
    }
    return {a, unit_normal(a, b, c)};
  }

  // They lie between points that are kept off one node of the lattice, where the mesh passes through it.
  [[nodiscard]] bool is_needle(std::uint32_t face) const {
    const Triangle& t = triangle(face);
    const Vec3 u = position(t[1]) - position(t[0]), v = position(t[2]) - position(t[0]), w = v - u;
    const Vec3 normal = cross(u, v);
    return dot(normal, normal) < needle_ * needle_ * std::max({dot(u, u), dot(v, v), dot(w, w)});
  }

  void find_neighbours(std::uint32_t v, std::vector<std::uint32_t>& all) const {
    all.clear();
    for (const std::uint32_t face : star_[v]) {
      for (const std::uint32_t corner : triangle(face)) {
        if (corner != v) all.push_back(corner);
      }
    }
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());  // clang 14 knows no subranges
  }

  [[nodiscard]] double quality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal) const {
    const Vec3 u = b - a, v = c - a, w = c - b;
    return dot(cross(u, v), normal) / 2.0 / std::max({dot(u, u), dot(v, v), dot(w, w)});
  }

  // The worst of the faces around v; with v pulled into `target`, of those that are left. The search ends at one that
  // is not above `needed`.
  [[nodiscard]] double worst_quality(std::uint32_t v, std::uint32_t target, bool with_needles,
                                     double needed = -std::numeric_limits<double>::infinity()) const {
    double worst = std::numeric_limits<double>::infinity();
    for (const std::uint32_t face : star_[v]) {
      if (!(worst > needed)) break;
      const Triangle& t = triangle(face);
      if ((v != target && has(t, target)) || (needles_[face] && !with_needles)) continue;
      std::array<Vec3, 3> corners;
      std::ranges::transform(t, corners.begin(), [&](std::uint32_t c) { return position(c == v ? target : c); });
      worst = std::min(worst, quality(corners[0], corners[1], corners[2], planes_[face].normal));
    }
    return worst;
  }

  // A vertex at the same node of the lattice that v can be pulled into: of those in most planes there the nearest.
  // Needles have no say; they vanish as all points at a node become one.
  [[nodiscard]] std::optional<std::uint32_t> target_at_node(std::uint32_t v) {
    constexpr double kMayLose = 0.25;
    const auto is_needle = [&](std::uint32_t face) { return needles_[face]; };
    if (std::ranges::none_of(star_[v], is_needle)) return std::nullopt;
    find_neighbours(v, around_);
    const std::vector<std::uint32_t> faces = faces_at_node(v, around_);
    const double needed = std::max(0.0, kMayLose * std::min(kLeastQuality, worst_quality(v, v, false)));
    std::optional<std::uint32_t> best;
    std::pair best_rank(planes_through(v, faces), -needle_);
    for (const std::uint32_t target : around_) {
      const std::pair rank(planes_through(target, faces), -distance(v, target));
      if (!(rank > best_rank) || !is_at_node(v, target) || !stays_in_planes(v, target, false)) continue;
      if (!(worst_quality(v, target, false, needed) > needed) || !keeps_topology(target)) continue;
      best = target;
      best_rank = rank;
    }
    return best;
  }

  [[nodiscard]] double distance(std::uint32_t v, std::uint32_t w) const {
    const Vec3 step = position(w) - position(v);
    return std::sqrt(dot(step, step));
  }
  [[nodiscard]] bool is_at_node(std::uint32_t v, std::uint32_t w) const { return distance(v, w) < needle_; }

  // That are no needles, at v and its neighbours there.
  [[nodiscard]] std::vector<std::uint32_t> faces_at_node(std::uint32_t v,
                                                         const std::vector<std::uint32_t>& around) const {
    std::vector<std::uint32_t> faces;
    const auto add = [&](std::uint32_t vertex) {
      std::ranges::copy_if(star_[vertex], std::back_inserter(faces), [&](std::uint32_t f) { return !needles_[f]; });
    };
    add(v);
    for (const std::uint32_t neighbour : around) {
      if (is_at_node(v, neighbour)) add(neighbour);
    }
    return faces;
  }
  [[nodiscard]] std::ptrdiff_t planes_through(std::uint32_t v, const std::vector<std::uint32_t>& faces) const {
    return std::ranges::count_if(faces, [&](std::uint32_t f) { return planes_[f].distance(position(v)) <= most_; });
  }

  // The vertex that v can be pulled into with the best faces around.
  [[nodiscard]] std::optional<std::uint32_t> best_target(std::uint32_t v) {
    find_neighbours(v, around_);
    std::optional<std::uint32_t> best;
    std::optional<double> best_quality;  // most vertices have no target in their planes, and need none
    for (const std::uint32_t target : around_) {
      if (!stays_in_planes(v, target, true)) continue;
      if (!best_quality) best_quality = std::max(0.0, std::min(kLeastQuality, worst_quality(v, v, true)));
      const double worst = worst_quality(v, target, true, *best_quality);
      if (worst > *best_quality && keeps_topology(target)) {
        best = target;
        best_quality = worst;
      }
    }
    return best;
  }

  [[nodiscard]] bool stays_in_planes(std::uint32_t v, std::uint32_t target, bool with_needles) const {
    return std::ranges::all_of(star_[v], [&](std::uint32_t face) {
      return (needles_[face] && !with_needles) || planes_[face].distance(position(target)) <= most_;
    });
  }

  // The link condition (Dey, Edelsbrunner, Guha, Nekhayev 1999): two vertices have no neighbours in common but those of
  // their two faces. Of `target` and the vertex that around_ is around.
  [[nodiscard]] bool keeps_topology(std::uint32_t target) {
    find_neighbours(target, around_target_);
    const auto is_common = [&](std::uint32_t neighbour) { return std::ranges::binary_search(around_, neighbour); };
    return std::ranges::count_if(around_target_, is_common) == 2;
  }

  void pull(std::uint32_t v, std::uint32_t target) {
    find_neighbours(v, around_);
    for (const std::uint32_t neighbour : around_) {
      if (state_[neighbour] != State::kKept) state_[neighbour] = State::kNext;
    }
    for (const std::uint32_t face : star_[v]) {
      Triangle& t = triangle(face);
      if (has(t, target)) {
        for (const std::uint32_t corner : t) {
          if (corner != v) std::erase(star_[corner], face);
        }
        t = {};
      } else {
        std::ranges::replace(t, v, target);
        star_[target].push_back(face);
        if (needles_[face]) {
          needles_[face] = is_needle(face);
          planes_[face] = plane_of(face);
        }
      }
    }
    star_[v].clear();
    into_[v] = target;
  }

  SurfaceMesh surface_;
  const TriangleMesh& input_;
  double most_, needle_;
  std::vector<FacePlane> planes_;
  std::vector<bool> needles_;
  std::vector<std::vector<std::uint32_t>> star_;  // faces
  std::vector<State> state_;
  std::vector<std::uint32_t> into_;
  std::vector<std::uint32_t> around_, around_target_;  // neighbours in increasing order, of what is looked at
};

}  // namespace

MergedSurface merge_planes(const SurfaceMesh& surface, const TriangleMesh& input, const std::vector<bool>& kept,
                           double most, double needle) {
  return Merger(surface, input, kept, most, needle).merge();
}

}  // namespace raycone
