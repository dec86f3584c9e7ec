// Closed patches within bodies that are not closed.
#pragma once

#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/orientation/closed_patches.h"
#include "core/orientation/surface_samples.h"

namespace raycone {

// The open faces of a mesh.
struct OpenBodies {
  std::vector<Triangle> turned;     // all of them
  std::vector<Triangle> as_stored;  // those of pieces whose faces agree as stored
  // 1 where `as_stored` is `turned`, -1 where it is that the other way round, else 0.
  int relation = 0;
};

// Turns closed patches that lie outside all other closed ones, each together with what lies in it, where they lie
// within open bodies: where these wind around all samples of the patch by more than half a turn, one way. If the faces
// of the patch agree as stored, and if those of the bodies do that are enough to wind so, the relation stays as stored.
// Else the patch becomes a cavity. Of many patches, the thousand with the largest samples are looked at. Returns
// whether anything was turned. Depends on coordinates only. `vertices`: in_unit_box(). Uses the threads that
// ThreadLimit allows; needs DefaultFloatingPoint.
bool turn_within_open_bodies(const std::vector<ClosedPatch>& patches, const OpenBodies& bodies,
                             const NumberedVertices& vertices, ClosedSigns& signs);

}  // namespace raycone
