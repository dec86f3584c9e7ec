// Which closed surface lies within which.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/vec3.h"
#include "core/orientation/closed_surface.h"

namespace raycone {

// A surface lies within another one if its box does, if the other's winding number is 0 at none of its points, and if
// one of these points is off the other one. Its points are its vertices and points_on_faces(): 1024 of the latter or,
// of more than 128 surfaces, fewer, but at least 16. So a bar across the opening of a frame is not within it, although
// its ends are, and a hole that is drilled through a block is. A point closer to the other surface than 2^-20 of half
// its longest side may be there by rounding: it counts only if all points are as close. Where no face of the other
// surface comes near the box, one point tells of all. Winding numbers are exact, and nothing depends on the order of
// faces or vertices. Both functions use the threads that ThreadLimit allows.

// For each surface the others within which it lies, by number. Takes n^2 time and memory for n boxes within each other.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> surfaces_around(const std::vector<const ClosedSurface*>& surfaces,
                                                                      const std::vector<Vec3>& vertices);

// Of these surfaces, by number, those that lie within no other one, ascending. Surfaces within each other take little
// time: the outermost one settles all others.
[[nodiscard]] std::vector<std::uint32_t> not_surrounded(std::vector<std::uint32_t> asked,
                                                        const std::vector<const ClosedSurface*>& surfaces,
                                                        const std::vector<Vec3>& vertices);

}  // namespace raycone
