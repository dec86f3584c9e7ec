#include "core/merging/repeated_check.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

#include "core/mesh/exterior_edges.h"

namespace raycone {

SurfaceFaults RepeatedCheck::faults(const MergedFaces& merged, const TriangleMesh& mesh, NodeSet& misplaced) const {
  constexpr std::size_t kFew = 4;  // where more of a mesh is new than one of these, all is looked at
  if (!is_known_) return faults_of(mesh, inside_, &misplaced);
  SurfaceEdit change;
  change.faces = faces_to_check(merged, mesh);
  if (kFew * change.faces.size() > merged.faces.size()) return faults_of(mesh, inside_, &misplaced);
  SurfaceFaults faults = faults_near(mesh, change, inside_.lattice()).faults;
  const std::vector<ExteriorEdge> none;
  misplaced = misplaced_nodes(mesh, inside_, faults.links > 0 ? nullptr : &none);
  faults.nodes = misplaced.size();
  return faults;
}

void RepeatedCheck::remember_whole(const SurfaceMesh& surface) {
  is_known_ = true;
  faces_.resize(surface.sources.size());
  std::iota(faces_.begin(), faces_.end(), 0U);
  triangles_ = surface.mesh.triangles;
  mesh_ = surface.mesh;
  faulty_.assign(faces_.size(), false);
}

void RepeatedCheck::remember(const MergedFaces& merged, const TriangleMesh& mesh, const SurfaceFaults& faults) {
  is_known_ = faults.edges + faults.links + faults.degenerate_faces + faults.equal_vertices == 0;
  faces_ = merged.faces;
  triangles_ = merged.triangles;
  mesh_ = mesh;
  faulty_ = faults.intersections.of_triangle;
}

// Also all faces at vertices where one is gone: around others the fans are as they were.
std::vector<std::uint32_t> RepeatedCheck::faces_to_check(const MergedFaces& merged, const TriangleMesh& mesh) const {
  std::vector<bool> touched(vertices_, false);
  const auto touch = [&](const Triangle& t) {
    for (const std::uint32_t corner : t) touched[corner] = true;
  };
  const auto is_same = [&](std::size_t before, std::size_t now) {
    if (triangles_[before] != merged.triangles[now]) return false;
    for (std::size_t n = 0; n < 3; ++n) {
      if (mesh_.vertices[mesh_.triangles[before][n]] != mesh.vertices[mesh.triangles[now][n]]) return false;
    }
    return true;
  };
  std::vector<bool> again(merged.faces.size(), false);
  std::size_t before = 0;
  for (std::size_t now = 0; now < merged.faces.size(); ++now) {
    for (; before < faces_.size() && faces_[before] < merged.faces[now]; ++before) touch(triangles_[before]);
    const bool was_there = before < faces_.size() && faces_[before] == merged.faces[now];
    const bool same = was_there && is_same(before, now);
    if (was_there && !same) touch(triangles_[before]);
    if (!same) touch(merged.triangles[now]);
    again[now] = same && faulty_[before];
    before += was_there ? 1 : 0;
  }
  for (; before < faces_.size(); ++before) touch(triangles_[before]);
  std::vector<std::uint32_t> faces;
  for (std::uint32_t face = 0; face < merged.faces.size(); ++face) {
    const auto is_touched = [&](std::uint32_t corner) { return touched[corner]; };
    if (again[face] || std::ranges::any_of(merged.triangles[face], is_touched)) faces.push_back(face);
  }
  return faces;
}

}  // namespace raycone
