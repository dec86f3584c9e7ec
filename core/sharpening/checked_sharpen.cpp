#include "core/sharpening/checked_sharpen.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/cells/node_set.h"
#include "core/certificate/certificate.h"
#include "core/certificate/fault_places.h"
#include "core/certificate/surface_edit.h"
#include "core/machine/threads.h"
#include "core/sharpening/corner_gaps.h"
#include "core/sharpening/lattice_crossings.h"

namespace raycone {
namespace {

// Looks where a surface crosses edges of the lattice off the mesh: where the lattice looked, it was right before.
class LatticeEdges {
 public:
  LatticeEdges(const SharpenInput& input, const Lattice& lattice, const SharpenLimits& limits)
      : input_(input), lattice_(lattice), limits_(limits) {}

  // The vertices of faces that do so since they were changed. Not those that fill_corner_gaps() mends: then the surface
  // is left with these gaps filled, if there are no others.
  [[nodiscard]] std::vector<std::uint32_t> left_off(SurfaceMesh& surface, const SurfaceEdit& change) const {
    const std::vector<FaceOff> off = faces_off(surface, change);
    if (off.empty()) return {};
    NodeSet nodes(lattice_);
    for (const FaceOff& face : off) add_corners(face.points, nodes);
    SurfaceMesh filled = surface;
    drop_gone(filled);
    if (fill_corner_gaps(filled, input_, lattice_, limits_)) nodes = nodes_off(filled, nodes);
    std::vector<std::uint32_t> vertices;
    for (const FaceOff& face : off) {
      const auto is_left = [&](const Vec3& p) { return is_beside(p, nodes); };
      if (std::ranges::any_of(face.points, is_left)) vertices.insert(vertices.end(), face.t.begin(), face.t.end());
    }
    if (vertices.empty()) surface = std::move(filled);
    return vertices;
  }

 private:
  struct FaceOff {
    Triangle t;
    std::vector<Vec3> points;
  };

  [[nodiscard]] std::vector<Vec3> points_off(const SurfaceMesh& surface, std::uint32_t face) const {
    const Triangle& t = surface.mesh.triangles[face];
    if (is_gone(t) || surface.sources[face] == kHole) return {};
    const std::vector<Vec3>& vertices = surface.mesh.vertices;
    return crossings_off_mesh({vertices[t[0]], vertices[t[1]], vertices[t[2]]}, lattice_, input_.distance, limits_.off);
  }

  [[nodiscard]] std::vector<FaceOff> faces_off(const SurfaceMesh& surface, const SurfaceEdit& change) const {
    std::vector<std::vector<Vec3>> points(change.faces.size());
    parallel_for_each(points.size(), 64, [&](std::size_t n) { points[n] = points_off(surface, change.faces[n]); });
    std::vector<FaceOff> off;
    for (std::size_t n = 0; n < points.size(); ++n) {
      if (!points[n].empty()) off.push_back({surface.mesh.triangles[change.faces[n]], std::move(points[n])});
    }
    return off;
  }

  // Of the cells that the points are in.
  void add_corners(const std::vector<Vec3>& points, NodeSet& nodes) const {
    for (const Vec3& p : points) {
      for (const NodeSet::Node& node : corners_of_cell_at(p, lattice_)) nodes.insert(node[0], node[1], node[2]);
    }
  }

  // The corners of cells where faces beside `nodes` do so.
  [[nodiscard]] NodeSet nodes_off(const SurfaceMesh& surface, const NodeSet& nodes) const {
    const std::vector<bool> beside = faces_beside(surface.mesh.vertices, surface.mesh.triangles, nodes);
    NodeSet found(lattice_);
    for (std::uint32_t face = 0; face < beside.size(); ++face) {
      if (beside[face]) add_corners(points_off(surface, face), found);
    }
    return found;
  }

  const SharpenInput& input_;
  const Lattice& lattice_;
  const SharpenLimits& limits_;
};

}  // namespace

bool checked_sharpen(SurfaceMesh& surface, const SharpenInput& input, const Lattice& lattice,
                     const SharpenLimits& limits, int rounds) {
  constexpr int kPartialRounds = 6;
  Sharpener sharpener(surface, input, limits);
  SurfaceEdit change = sharpener.sharpen();
  const LatticeEdges edges(input, lattice, limits);
  NodeSet misplaced(lattice);
  for (int round = 0; round < rounds && sharpener.pulls() > 0; ++round) {
    NearFaults near = faults_near(surface.mesh, change, lattice);
    misplaced.flip(changed_nodes(surface.mesh, change, lattice));
    if (near.faults.none() && misplaced.empty()) {
      near.vertices = edges.left_off(surface, sharpener.all_changes());
      if (near.vertices.empty()) {
        sharpener.finish();
        return true;
      }
    }
    sharpener.for_each_target([&](std::uint32_t vertex, const Vec3& p) {
      if (is_beside(p, misplaced)) near.vertices.push_back(vertex);
    });
    using Kept = Sharpener::Kept;
    change = sharpener.keep(near.vertices, round < kPartialRounds ? Kept::kPulled : Kept::kStrips);
    if (change.changes_nothing()) break;  // such faults do not come from pulls
  }
  sharpener.undo();
  return false;
}

}  // namespace raycone
