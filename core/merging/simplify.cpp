#include "core/merging/simplify.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "core/cells/triangle_shape.h"
#include "core/merging/star_change.h"
#include "core/mesh/vertex_faces.h"

namespace raycone {
namespace {

// Pulls make no face of less shape_of(), unless there was one before.
constexpr double kLeastShapeOfPull = 2e-2;

class Simplifier {
 public:
  Simplifier(const SurfaceMesh& surface, const NodeSet& inside, const std::vector<bool>& kept)
      : surface_(surface),
        lattice_(inside.lattice()),
        kept_(kept),
        off_(surface.mesh.triangles.size(), 0.0),
        into_(surface.mesh.vertices.size()),
        seen_in_(surface.mesh.vertices.size(), 0) {
    const VertexFaces faces(surface.mesh);
    for (std::uint32_t v = 0; v < into_.size(); ++v) {
      const auto star = faces.of(v);
      star_.emplace_back(star.begin(), star.end());
      into_[v] = v;
    }
  }

  // What costs little comes first.
  MergedFaces simplify(double most) {
    for (const double part : {1.0 / 64, 1.0 / 16, 1.0 / 4, 1.0}) pull_all(part * most);
    for (std::uint32_t& target : into_) {
      while (into_[target] != target) target = into_[target];
    }
    MergedFaces result{{}, {}, std::move(into_), {}};
    for (std::size_t face = 0; face < off_.size(); ++face) {
      const Triangle& t = surface_.mesh.triangles[face];
      if (t[0] == t[1]) continue;
      result.triangles.push_back(t);
      result.sources.push_back(surface_.sources[face]);
    }
    return result;
  }

 private:
  struct Pull {
    std::uint32_t target;
    double off, shape;  // of the faces that it leaves: the most, and the least
  };

  // In each pass no vertex is pulled that a neighbour was pulled into, so that faces grow evenly.
  void pull_all(double most) {
    std::vector<bool> waits(into_.size(), true);
    for (bool pulled = true; pulled;) {
      pulled = false;
      std::vector<bool> next(into_.size(), false);
      for (std::uint32_t v = 0; v < into_.size(); ++v) {
        if (!waits[v] || next[v] || kept_[v] || star_[v].empty()) continue;
        const std::optional<Pull> best = best_pull(v, most);
        if (!best) continue;
        for (const std::uint32_t neighbour : ring_of(v)) next[neighbour] = true;
        pull(v, *best);
        pulled = true;
      }
      waits = std::move(next);
    }
  }

  [[nodiscard]] static bool has(const Triangle& t, std::uint32_t v) { return t[0] == v || t[1] == v || t[2] == v; }

  // The vertices around v, in the order of the faces there.
  [[nodiscard]] std::vector<std::uint32_t> ring_of(std::uint32_t v) const {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sides;
    for (const std::uint32_t face : star_[v]) {
      const Triangle& t = surface_.mesh.triangles[face];
      const std::size_t at = place_in(t, v);
      sides.emplace_back(t[(at + 1) % 3], t[(at + 2) % 3]);
    }
    std::vector<std::uint32_t> ring{sides.front().first};
    while (ring.size() < sides.size()) {
      const auto next = std::ranges::find(sides, ring.back(), [](const auto& side) { return side.first; });
      ring.push_back(next->second);
    }
    return ring;
  }

  [[nodiscard]] std::optional<Pull> best_pull(std::uint32_t v, double most) {
    const std::vector<std::uint32_t> ring = ring_of(v);
    ++look_;
    std::vector<Vec3> places;
    for (const std::uint32_t neighbour : ring) {
      places.push_back(surface_.mesh.vertices[neighbour]);
      seen_in_[neighbour] = look_;
    }
    StarChange change(surface_.mesh.vertices[v], places);
    double before = 0.0, shape = kLeastShapeOfPull;
    for (const std::uint32_t face : star_[v]) {
      before = std::max(before, off_[face]);
      shape = std::min(shape, shape_of_face(face));
    }
    std::optional<Pull> best;
    for (std::size_t n = 0; n < ring.size(); ++n) {
      if (!keeps_topology(ring[n], ring.size())) continue;
      const double here = least_shape(places, n);
      const double left = (best ? std::min(most, most_instead(*best, here)) : most) - before;
      if (!(here >= shape) || !(left > 0.0)) continue;
      change.pull_into(n);
      const std::optional<double> distance = change.distance(left);
      if (!distance || change.passes_node(lattice_, *distance)) continue;
      best = Pull{ring[n], before + *distance, here};
    }
    return best;
  }

  // What a pull that leaves faces of this shape may cost to be better: in flat parts all cost what rounding does, and
  // the one is taken that leaves the roundest faces.
  [[nodiscard]] double most_instead(const Pull& other, double shape) const {
    constexpr double kSame = 1e-9;  // voxels
    const double same = kSame * lattice_.least_spacing();
    return other.off + (shape > other.shape ? same : -same);
  }

  [[nodiscard]] double shape_of_face(std::uint32_t face) const {
    const Triangle& t = surface_.mesh.triangles[face];
    const std::vector<Vec3>& at = surface_.mesh.vertices;
    return shape_of(at[t[0]], at[t[1]], at[t[2]]);
  }

  // Of the faces around a vertex when it is pulled into that neighbour.
  [[nodiscard]] static double least_shape(const std::vector<Vec3>& ring, std::size_t target) {
    double least = 1.0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const std::size_t next = (i + 1) % ring.size();
      if (i != target && next != target) least = std::min(least, shape_of(ring[target], ring[i], ring[next]));
    }
    return least;
  }

  // As PatchMerger::keeps_topology() has it; besides, a tetrahedron is as small as a closed surface gets. The
  // vertex that is looked at has so many neighbours.
  [[nodiscard]] bool keeps_topology(std::uint32_t target, std::size_t neighbours) const {
    std::size_t common = 0;  // each is a corner of two faces
    for (const std::uint32_t face : star_[target]) {
      for (const std::uint32_t corner : surface_.mesh.triangles[face]) {
        common += corner != target && seen_in_[corner] == look_ ? 1 : 0;
      }
    }
    return common == 2 * 2 && neighbours + star_[target].size() > 6;
  }

  void pull(std::uint32_t v, const Pull& by) {
    for (const std::uint32_t face : star_[v]) {
      Triangle& t = surface_.mesh.triangles[face];
      if (has(t, by.target)) {
        for (const std::uint32_t corner : t) {
          if (corner != v) std::erase(star_[corner], face);
        }
        t = {};
      } else {
        std::ranges::replace(t, v, by.target);
        star_[by.target].push_back(face);
        off_[face] = by.off;
      }
    }
    star_[v].clear();
    into_[v] = by.target;
  }

  SurfaceMesh surface_;
  const Lattice& lattice_;
  const std::vector<bool>& kept_;
  std::vector<double> off_;  // of each face: how far its points, and those it stands for, are from where they were
  std::vector<std::vector<std::uint32_t>> star_;  // faces
  std::vector<std::uint32_t> into_;
  std::uint64_t look_ = 0;              // how many vertices were looked at
  std::vector<std::uint64_t> seen_in_;  // of each vertex: in which look it was a neighbour last
};

}  // namespace

MergedFaces simplify(const SurfaceMesh& surface, const NodeSet& inside, const std::vector<bool>& kept, double most) {
  return Simplifier(surface, inside, kept).simplify(most);
}

}  // namespace raycone
