#include "core/sharpening/checked_sharpen.h"

#include <cstdint>

#include "core/cells/node_set.h"
#include "core/certificate/certificate.h"
#include "core/certificate/fault_places.h"
#include "core/certificate/surface_edit.h"

namespace raycone {

bool checked_sharpen(SurfaceMesh& surface, const SharpenInput& input, const Lattice& lattice,
                     const SharpenLimits& limits, int rounds) {
  constexpr int kPartialRounds = 6;
  Sharpener sharpener(surface, input, limits);
  SurfaceEdit change = sharpener.sharpen();
  NodeSet misplaced(lattice);
  for (int round = 0; round < rounds && sharpener.pulls() > 0; ++round) {
    NearFaults near = faults_near(surface.mesh, change, lattice);
    misplaced.flip(changed_nodes(surface.mesh, change, lattice));
    if (near.faults.none() && misplaced.empty()) {
      sharpener.finish();
      return true;
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
