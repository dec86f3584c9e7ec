// Which closed surface is the innermost of those around another one.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/vec3.h"
#include "core/orientation/closed_surface.h"

namespace raycone {

struct NestingTree {
  std::vector<std::uint32_t> parent;  // per surface the innermost around it; itself where there is none
  std::vector<std::uint32_t> order;   // all surfaces, each after its parent
};

// `around` is surfaces_around(). The innermost is the one at the end of the longest chain of surfaces around each
// other; of several, the one with the first face by coordinates. Where surfaces pass through each other, one that is
// around another need not be around what lies in that. Two that are around each other do not count for each other. Of
// more, in a circle, the one with the first face comes before those around it. Depends on coordinates only. Takes time
// in proportion to `around`, and n log n for n surfaces if there are circles. Preconditions: no two surfaces have a
// face in common; the lists of `around` are sorted, and the box of each surface holds those that it is around.
[[nodiscard]] NestingTree nesting_tree(std::vector<std::vector<std::uint32_t>> around,
                                       const std::vector<const ClosedSurface*>& surfaces,
                                       const std::vector<Vec3>& vertices);

}  // namespace raycone
