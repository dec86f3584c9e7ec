// Triangles without height, taken out of a closed mesh.
#pragma once

#include "core/arrangement/rule_border.h"

namespace raycone {

// Makes one vertex of those within `distance` of each other, as representatives_within() does; and where a corner of a
// triangle is as near to the opposite side, a corner of all triangles at that side. Where a neighbour of a corner is as
// near to the triangle's inside, it is cut in three. This is repeated until nothing changes, at most a few times; a
// round that would make too many triangles is left out. In the end there are no triangles with two equal corners, no
// two that are one in opposite directions, and no unused vertices. The boundary stays empty. So what rounding may have
// turned over is flat, and nothing has moved by more than a few distances. Precondition: `distance`, in the border's
// units, is positive. Needs DefaultFloatingPoint.
void snap(RuleBorder& border, double distance);

}  // namespace raycone
