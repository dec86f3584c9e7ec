// Triangles without height, taken out of a closed mesh.
#pragma once

#include "core/arrangement/rule_border.h"

namespace raycone {

// Makes one vertex of those within `distance` of each other, as representatives_within() does; and where a corner of a
// triangle is as near to the opposite side, a corner of all triangles at that side. Where a neighbour of a corner is as
// near to the triangle's inside, it is cut in three. Again, until there are none, or a few times, or until there
// would be many times as many. Triangles of two equal corners are gone then, pairs that are one in either direction, and
// vertices without triangles. The boundary stays empty. So what rounding may have turned over is flat, and nothing has
// moved by more than a few distances. Precondition: `distance`, in the border's units, is positive. Needs
// DefaultFloatingPoint.
void snap(RuleBorder& border, double distance);

}  // namespace raycone
