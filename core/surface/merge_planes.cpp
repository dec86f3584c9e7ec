#include "core/surface/merge_planes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
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
  Merger(const SurfaceMesh& surface, const TriangleMesh& input, const std::vector<bool>& kept, double most)
      : surface_(surface), most_(most), state_(surface.mesh.vertices.size(), State::kWaits) {
    const VertexFaces faces(surface.mesh);
    star_.reserve(state_.size());
    for (std::uint32_t v = 0; v < state_.size(); ++v) {
      const auto star = faces.of(v);
      star_.emplace_back(star.begin(), star.end());
      if (kept[v]) state_[v] = State::kKept;
    }
    for (std::size_t face = 0; face < surface_.mesh.triangles.size(); ++face) {
      planes_.push_back(plane_of(face, input));
    }
  }

  // In each pass no vertex is pulled that a neighbour was pulled into, so that faces grow evenly.
  SurfaceMesh merge() {
    for (bool pulled = true; pulled;) {
      pulled = false;
      for (std::uint32_t v = 0; v < state_.size(); ++v) {
        if (state_[v] != State::kWaits) continue;
        const std::optional<std::uint32_t> target = target_of(v);
        state_[v] = target ? State::kGone : State::kStays;
        if (!target) continue;
        pull(v, *target);
        pulled = true;
      }
      for (State& state : state_) state = state == State::kNext ? State::kWaits : state;
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
    return std::move(surface_);
  }

 private:
  enum class State : std::uint8_t {
    kWaits,  // to be looked at
    kNext,   // in the next pass
    kStays,  // until something changes around it
    kKept,   // for ever
    kGone,
  };

  [[nodiscard]] const Vec3& position(std::uint32_t v) const { return surface_.mesh.vertices[v]; }
  [[nodiscard]] Triangle& triangle(std::uint32_t face) { return surface_.mesh.triangles[face]; }
  [[nodiscard]] const Triangle& triangle(std::uint32_t face) const { return surface_.mesh.triangles[face]; }
  [[nodiscard]] bool is_gone(std::size_t face) const {
    return surface_.mesh.triangles[face][0] == surface_.mesh.triangles[face][1];
  }
  [[nodiscard]] static bool has(const Triangle& t, std::uint32_t v) { return t[0] == v || t[1] == v || t[2] == v; }

  [[nodiscard]] FacePlane plane_of(std::size_t face, const TriangleMesh& input) const {
    const Triangle& t = surface_.mesh.triangles[face];
    const Vec3 &a = position(t[0]), &b = position(t[1]), &c = position(t[2]);
    if (surface_.sources[face] != kHole) {
      const Triangle& source = input.triangles[static_cast<std::size_t>(surface_.sources[face])];
      const Vec3 normal = unit_normal(input.vertices[source[0]], input.vertices[source[1]], input.vertices[source[2]]);
      const Vec3 own = cross(b - a, c - a);
      const FacePlane plane{a, dot(normal, own) < 0.0 ? -1.0 * normal : normal};
      if (plane.distance(b) <= most_ && plane.distance(c) <= most_) return plane;
    }
    return {a, unit_normal(a, b, c)};
  }

  [[nodiscard]] std::vector<std::uint32_t> neighbours(std::uint32_t v) const {
    std::vector<std::uint32_t> all;
    for (const std::uint32_t face : star_[v]) {
      for (const std::uint32_t corner : triangle(face)) {
        if (corner != v) all.push_back(corner);
      }
    }
    std::ranges::sort(all);
    const auto repeated = std::ranges::unique(all);
    all.erase(repeated.begin(), repeated.end());
    return all;
  }

  [[nodiscard]] double quality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal) const {
    const Vec3 u = b - a, v = c - a, w = c - b;
    return dot(cross(u, v), normal) / 2.0 / std::max({dot(u, u), dot(v, v), dot(w, w)});
  }

  // The worst of the faces around v; with v pulled into `target`, of those that are left.
  [[nodiscard]] double worst_quality(std::uint32_t v, std::uint32_t target) const {
    double worst = std::numeric_limits<double>::infinity();
    for (const std::uint32_t face : star_[v]) {
      const Triangle& t = triangle(face);
      if (v != target && has(t, target)) continue;
      std::array<Vec3, 3> corners;
      std::ranges::transform(t, corners.begin(), [&](std::uint32_t c) { return position(c == v ? target : c); });
      worst = std::min(worst, quality(corners[0], corners[1], corners[2], planes_[face].normal));
    }
    return worst;
  }

  // The vertex that v can be pulled into with the best faces around.
  [[nodiscard]] std::optional<std::uint32_t> target_of(std::uint32_t v) const {
    const std::vector<std::uint32_t> around = neighbours(v);
    std::optional<std::uint32_t> best;
    double best_quality = std::min(kLeastQuality, worst_quality(v, v));
    if (!(best_quality > 0.0)) best_quality = 0.0;
    for (const std::uint32_t target : around) {
      if (!stays_in_planes(v, target)) continue;
      const double worst = worst_quality(v, target);
      if (worst > best_quality && keeps_topology(target, around)) {
        best = target;
        best_quality = worst;
      }
    }
    return best;
  }

  [[nodiscard]] bool stays_in_planes(std::uint32_t v, std::uint32_t target) const {
    return std::ranges::all_of(star_[v],
                               [&](std::uint32_t face) { return planes_[face].distance(position(target)) <= most_; });
  }

  // The link condition (Dey, Edelsbrunner, Guha, Nekhayev 1999): two vertices have no neighbours in common but those of
  // their two faces.
  [[nodiscard]] bool keeps_topology(std::uint32_t target, const std::vector<std::uint32_t>& around) const {
    std::size_t common = 0;
    for (const std::uint32_t neighbour : neighbours(target)) {
      common += std::ranges::binary_search(around, neighbour) ? 1 : 0;
    }
    return common == 2;
  }

  void pull(std::uint32_t v, std::uint32_t target) {
    for (const std::uint32_t neighbour : neighbours(v)) {
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
      }
    }
    star_[v].clear();
  }

  SurfaceMesh surface_;
  double most_;
  std::vector<FacePlane> planes_;
  std::vector<std::vector<std::uint32_t>> star_;  // faces
  std::vector<State> state_;
};

}  // namespace

SurfaceMesh merge_planes(const SurfaceMesh& surface, const TriangleMesh& input, const std::vector<bool>& kept,
                         double most) {
  return Merger(surface, input, kept, most).merge();
}

}  // namespace raycone
