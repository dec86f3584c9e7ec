// Closed patches within bodies that are not closed.
#pragma once

#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/orientation/closed_patches.h"
#include "core/orientation/surface_samples.h"

namespace raycone {

// The open faces of a mesh.
struct OpenBodies {
  std::vector<Triangle> turned;     // all of them, as turned
  std::vector<Triangle> as_stored;  // of pieces whose faces agree as stored, as they are stored
  // 1 where `as_stored` is `turned`, -1 where it is `turned` with all faces reversed, else 0.
  int relation = 0;
};

// Turns, where need be, closed patches that lie within open bodies and outside all other closed patches; each together
// with what lies in it. A patch lies within the bodies if these wind around all of its samples by more than half a
// turn, one way. If the patch's faces agree as stored, and the bodies' faces that do so wind around it as far, patch
// and bodies keep their relation as stored. Else the patch becomes a cavity. Only the thousand patches with the largest
// samples are looked at. `signs` is changed; returns whether any patch was turned. Depends on coordinates only.
// `vertices`: in_unit_box(). Uses the threads that ThreadLimit allows; needs DefaultFloatingPoint.
bool turn_within_open_bodies(const std::vector<ClosedPatch>& patches, const OpenBodies& bodies,
                             const NumberedVertices& vertices, ClosedSigns& signs);

}  // namespace raycone
