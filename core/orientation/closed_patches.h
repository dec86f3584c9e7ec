// How closed patches are turned.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/vec3.h"
#include "core/orientation/closed_surface.h"

namespace raycone {

// A closed patch, or several open ones that close each other.
struct ClosedPatch {
  ClosedSurface surface;  // turned to agree
  // 1: all of its faces agree as stored, and with `surface`; -1: agree as stored, the other way round; 0: do not agree,
  // or have no opinion.
  int stored = 0;
};

struct ClosedSigns {
  std::vector<int> sign;                 // per patch 1 where it stays as its surface is, -1 where it is reversed
  std::vector<std::uint32_t> outermost;  // per patch the one with none around it that it lies in; maybe itself
};

// Outward outside all others, and within another one as orient() says. Outward is what makes the volume positive; where
// it is 0, the first face by coordinates decides. nesting_tree() tells the innermost of those around a patch. Exact.
// Uses the threads that ThreadLimit allows; needs DefaultFloatingPoint.
[[nodiscard]] ClosedSigns turn_closed_patches(const std::vector<ClosedPatch>& patches,
                                              const std::vector<Vec3>& vertices);

}  // namespace raycone
