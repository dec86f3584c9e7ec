// What polygons.cpp takes from CGAL: exact numbers, and a constrained Delaunay triangulation.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/vec3.h"

namespace raycone {

// All of these are exact for all finite doubles, and thread-safe; they need DefaultFloatingPoint.

// The direction of the polygon's area vector: each component of the exact vector, times one power of two, cut to 53
// bits; the largest is between 1/2 and 2. Zero if and only if the area vector is.
[[nodiscard]] Vec3 exact_area_direction(std::span<const Vec3> corners);

// Sign of det(b - a, c - a, direction): positive where a, b, c turn left, seen against the direction.
[[nodiscard]] int exact_turn(const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& c);

// Triangles, as indices into `corners`, that cover the polygon once in the projection along `direction`, which is not
// zero, and have its boundary; absent where the polygon is not simple there (core/polygons.h).
[[nodiscard]] std::optional<std::vector<std::array<std::uint32_t, 3>>> cut_polygon(std::span<const Vec3> corners,
                                                                                   const Vec3& direction);

}  // namespace raycone
