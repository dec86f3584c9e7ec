#include "core/sharpening/checked_sharpen.h"

#include <cstdint>
#include <vector>

#include "core/certificate/certificate.h"
#include "core/certificate/fault_places.h"
#include "core/certificate/surface_edit.h"
#include "core/sharpening/mixed_edges.h"

namespace raycone {

bool checked_sharpen(SurfaceMesh& surface, const SharpenInput& input, const NodeSet& inside,
                     const SharpenLimits& limits, int rounds) {
  constexpr int kPartialRounds = 6;
  const Lattice& lattice = inside.lattice();
  Sharpener sharpener(surface, input, limits);
  SurfaceEdit change = sharpener.sharpen();
  MixedEdges edges(input, inside, limits);
  NodeSet misplaced(lattice);
  for (int round = 0; round < rounds && sharpener.pulls() > 0; ++round) {
    NearFaults near = faults_near(surface.mesh, change, lattice);
    misplaced.flip(changed_nodes(surface.mesh, change, lattice));
    auto kept = Sharpener::Kept::kPulled;
    if (near.faults.none() && misplaced.empty()) {
      near.vertices = edges.vertices_off(surface, sharpener.all_changes());
      if (near.vertices.empty()) {
        sharpener.finish();
        return true;
      }
      kept = Sharpener::Kept::kPulledOffMesh;
    }
    sharpener.for_each_target([&](std::uint32_t vertex, const Vec3& p) {
      if (is_beside(p, misplaced)) near.vertices.push_back(vertex);
    });
    change = sharpener.keep(near.vertices, round < kPartialRounds ? kept : Sharpener::Kept::kStrips);
    if (change.changes_nothing()) break;  // such faults do not come from pulls
  }
  sharpener.undo();
  return false;
}

}  // namespace raycone
