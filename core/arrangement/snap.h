// Triangles without height, taken out of a closed mesh.
#pragma once

#include "core/arrangement/rule_border.h"

namespace raycone {

// Takes out of `border` what is thinner than `distance`. Vertices within `distance` of each other become one, as
// representatives_within() says. Where a corner of a triangle is that near to the opposite side, all triangles with
// that side are cut at the corner. Where a neighbour of a corner is that near to the triangle and over its inside, the
// triangle is cut in three there. The cuts are repeated until nothing changes, a few times at most; cuts at sides that
// would make too many triangles are left out. Triangles that rounding may have turned over end up without height, and
// nothing has moved by more than a few distances.
// The result has no triangles with two equal corners, no two with the same corners in opposite directions, and no
// unused vertices. The boundary stays empty. Precondition: `distance`, in the border's units, is positive. Needs
// DefaultFloatingPoint.
void snap(RuleBorder& border, double distance);

}  // namespace raycone
