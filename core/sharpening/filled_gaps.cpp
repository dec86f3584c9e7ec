#include "core/sharpening/filled_gaps.h"

#include <numeric>

#include "core/cells/node_set.h"
#include "core/cells/surface_mesh.h"
#include "core/certificate/certificate.h"
#include "core/certificate/fault_places.h"
#include "core/certificate/surface_edit.h"

namespace raycone {
namespace {

// A surface with fills, which can be taken back.
class FilledSurface {
 public:
  // Adds vertices and faces for the fills, and replaces the faces of all gaps.
  FilledSurface(SurfaceMesh& surface, const std::vector<FilledGap>& fills)
      : surface_(surface), first_vertices_(surface.mesh.vertices.size()), first_faces_(surface.mesh.triangles.size()) {
    std::vector<Triangle>& triangles = surface.mesh.triangles;
    for (const FilledGap& fill : fills) {
      std::vector<std::uint32_t> loop = fill.loop, faces = fill.faces;
      for (const Vec3& corner : fill.filled.corners) {
        loop.push_back(static_cast<std::uint32_t>(surface.mesh.vertices.size()));
        surface.mesh.vertices.push_back(corner);
      }
      while (faces.size() < fill.filled.triangles.size()) {
        faces.push_back(static_cast<std::uint32_t>(triangles.size()));
        triangles.push_back({});
        surface.sources.push_back(kHole);
      }
      begin_.push_back(edit_.faces.size());
      for (std::size_t n = 0; n < faces.size(); ++n) {
        Triangle after{};
        if (n < fill.filled.triangles.size()) {
          const auto [a, b, c] = fill.filled.triangles[n];
          after = {loop[a], loop[b], loop[c]};
        }
        edit_.faces.push_back(faces[n]);
        edit_.corners.push_back({triangles[faces[n]], after});
      }
    }
    begin_.push_back(edit_.faces.size());
    edit_.apply(surface.mesh);
  }

  // What that makes of the surface as it was.
  [[nodiscard]] const SurfaceEdit& edit() const { return edit_; }

  // The fills that have a vertex at faults, or a face beside a node that is misplaced, before or after.
  [[nodiscard]] std::vector<std::size_t> at_faults(const std::vector<std::uint32_t>& vertices,
                                                   const NodeSet& misplaced) const {
    std::vector<bool> touched(surface_.mesh.vertices.size(), false);
    for (const std::uint32_t v : vertices) touched[v] = true;
    std::vector<Triangle> faces;
    for (const SurfaceEdit::Corners& corners : edit_.corners) {
      faces.push_back(corners.before);
      faces.push_back(corners.after);
    }
    const std::vector<bool> beside = faces_beside(surface_.mesh.vertices, faces, misplaced);
    std::vector<std::size_t> found;
    for (std::size_t fill = 0; fill + 1 < begin_.size(); ++fill) {
      bool is_at_fault = false;
      for (std::size_t n = 2 * begin_[fill]; n < 2 * begin_[fill + 1]; ++n) {
        const auto& [a, b, c] = faces[n];
        is_at_fault = is_at_fault || (!is_gone(faces[n]) && (beside[n] || touched[a] || touched[b] || touched[c]));
      }
      if (is_at_fault) found.push_back(fill);
    }
    return found;
  }

  // One of these comes last. Drops what is gone; or back to the surface as it was.
  void finish(const std::vector<FilledGap>& fills) {
    for (std::size_t fill = 0; fill < fills.size(); ++fill) {
      const std::vector<std::int32_t>& sources = fills[fill].filled.sources;
      for (std::size_t n = 0; n < sources.size(); ++n) surface_.sources[edit_.faces[begin_[fill] + n]] = sources[n];
    }
    drop_gone(surface_);
  }
  void undo() {
    for (std::size_t n = 0; n < edit_.faces.size(); ++n)
      surface_.mesh.triangles[edit_.faces[n]] = edit_.corners[n].before;
    surface_.mesh.triangles.resize(first_faces_);
    surface_.mesh.vertices.resize(first_vertices_);
    surface_.sources.resize(first_faces_);
  }

 private:
  SurfaceMesh& surface_;
  std::size_t first_vertices_, first_faces_;
  SurfaceEdit edit_;                // fill by fill
  std::vector<std::size_t> begin_;  // of each fill's faces there, and the end
};

}  // namespace

std::vector<std::size_t> fill_all(SurfaceMesh& surface, const std::vector<FilledGap>& fills, const Lattice& lattice) {
  FilledSurface filled(surface, fills);
  const NearFaults near = faults_near(surface.mesh, filled.edit(), lattice);
  const NodeSet misplaced = changed_nodes(surface.mesh, filled.edit(), lattice);
  if (near.faults.none() && misplaced.empty()) {
    filled.finish(fills);
    return {};
  }
  std::vector<std::size_t> found = filled.at_faults(near.vertices, misplaced);
  if (found.empty()) {
    found.resize(fills.size());
    std::iota(found.begin(), found.end(), std::size_t{0});
  }
  filled.undo();
  return found;
}

}  // namespace raycone
