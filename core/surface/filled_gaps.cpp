#include "core/surface/filled_gaps.h"

#include <cstddef>
#include <utility>

#include "core/surface/certificate.h"
#include "core/surface/fault_places.h"
#include "core/surface/node_set.h"
#include "core/surface/surface_edit.h"

namespace raycone {
namespace {

// A surface with some of the fills, which can be taken back.
class FilledSurface {
 public:
  // Adds vertices and faces to the surface for all fills; these faces are gone at first.
  FilledSurface(SurfaceMesh& surface, std::vector<FilledGap> fills)
      : surface_(surface),
        fills_(std::move(fills)),
        first_vertices_(surface.mesh.vertices.size()),
        first_faces_(surface.mesh.triangles.size()) {
    for (FilledGap& fill : fills_) {
      for (const Vec3& corner : fill.filled.corners) {
        fill.loop.push_back(static_cast<std::uint32_t>(surface.mesh.vertices.size()));
        surface.mesh.vertices.push_back(corner);
      }
      while (fill.faces.size() < fill.filled.triangles.size()) {
        fill.faces.push_back(static_cast<std::uint32_t>(surface.mesh.triangles.size()));
        surface.mesh.triangles.push_back({});
        surface.sources.push_back(kHole);
      }
    }
    before_ = surface.mesh.triangles;
  }

  // Replaces the faces of all gaps that are left. Returns what that makes of the surface as it was at first.
  SurfaceEdit fill() {
    SurfaceEdit edit;
    surface_.mesh.triangles = before_;
    for (const FilledGap& fill : fills_) {
      for (std::size_t n = 0; n < fill.faces.size(); ++n) {
        Triangle& t = surface_.mesh.triangles[fill.faces[n]];
        t = n < fill.filled.triangles.size() ? triangle(fill, n) : Triangle{};
        edit.faces.push_back(fill.faces[n]);
        edit.corners.push_back({before_[fill.faces[n]], t});
      }
    }
    return edit;
  }

  // Drops what has a vertex that is at faults, or a face beside a node that is misplaced; all if that is none.
  void drop(const std::vector<std::uint32_t>& at_faults, const NodeSet& misplaced) {
    std::vector<bool> touched(surface_.mesh.vertices.size(), false);
    for (const std::uint32_t v : at_faults) touched[v] = true;
    std::vector<Triangle> faces;     // before and after
    std::vector<std::size_t> begin;  // of each fill
    for (const FilledGap& fill : fills_) {
      begin.push_back(faces.size());
      for (std::size_t n = 0; n < fill.faces.size(); ++n) {
        if (!is_gone(before_[fill.faces[n]])) faces.push_back(before_[fill.faces[n]]);
        if (n < fill.filled.triangles.size()) faces.push_back(triangle(fill, n));
      }
    }
    begin.push_back(faces.size());
    const std::vector<bool> beside = faces_beside(surface_.mesh.vertices, faces, misplaced);
    std::vector<FilledGap> left;
    for (std::size_t fill = 0; fill < fills_.size(); ++fill) {
      bool is_at_fault = false;
      for (std::size_t n = begin[fill]; n < begin[fill + 1]; ++n) {
        const auto& [a, b, c] = faces[n];
        is_at_fault = is_at_fault || beside[n] || touched[a] || touched[b] || touched[c];
      }
      if (!is_at_fault) left.push_back(std::move(fills_[fill]));
    }
    if (left.size() == fills_.size()) left.clear();
    fills_ = std::move(left);
  }

  [[nodiscard]] bool empty() const { return fills_.empty(); }

  // The last call. Drops what is gone.
  void finish() {
    for (const FilledGap& fill : fills_) {
      for (std::size_t n = 0; n < fill.filled.triangles.size(); ++n)
        surface_.sources[fill.faces[n]] = fill.filled.sources[n];
    }
    std::vector<std::int32_t> sources;
    std::vector<Triangle> triangles;
    for (std::size_t face = 0; face < surface_.sources.size(); ++face) {
      if (is_gone(surface_.mesh.triangles[face])) continue;
      sources.push_back(surface_.sources[face]);
      triangles.push_back(surface_.mesh.triangles[face]);
    }
    surface_.sources = std::move(sources);
    surface_.mesh = used_part(surface_.mesh.vertices, std::move(triangles));
  }
  // Or this: back to the surface as it was.
  void undo() {
    surface_.mesh.triangles = std::move(before_);
    surface_.mesh.triangles.resize(first_faces_);
    surface_.mesh.vertices.resize(first_vertices_);
    surface_.sources.resize(first_faces_);
  }

 private:
  // The n-th that fills a gap.
  static Triangle triangle(const FilledGap& fill, std::size_t n) {
    Triangle t = fill.filled.triangles[n];
    for (std::uint32_t& corner : t) corner = fill.loop[corner];
    return t;
  }

  SurfaceMesh& surface_;
  std::vector<FilledGap> fills_;
  std::size_t first_vertices_, first_faces_;
  std::vector<Triangle> before_;
};

}  // namespace

bool fill_without_faults(SurfaceMesh& surface, std::vector<FilledGap> fills, const Lattice& lattice) {
  constexpr int kRounds = 6;
  FilledSurface filled(surface, std::move(fills));
  for (int round = 0; round < kRounds && !filled.empty(); ++round) {
    const SurfaceEdit edit = filled.fill();
    const NearFaults near = faults_near(surface.mesh, edit, lattice);
    const NodeSet misplaced = changed_nodes(surface.mesh, edit, lattice);
    if (near.faults.none() && misplaced.empty()) {
      filled.finish();
      return true;
    }
    filled.drop(near.vertices, misplaced);
  }
  filled.undo();
  return false;
}

}  // namespace raycone
