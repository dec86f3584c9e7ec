// Points where planes meet, and points of a tetrahedron.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "core/data/vec3.h"

namespace raycone {

struct PointOnPlane {
  Vec3 point;
  Vec3 normal;  // of length 1
};

// The point of all these planes that is nearest to `near`; nothing where they have none in common, up to `tolerance`.
// Where planes agree but for 1e-5, they are one.
[[nodiscard]] std::optional<Vec3> common_point(std::span<const PointOnPlane> planes, const Vec3& near,
                                               double tolerance);

// Of a point relative to the first corner.
[[nodiscard]] std::array<double, 4> barycentric(const std::array<Vec3, 4>& corners, const Vec3& from_first);

// Whether a point, relative to the first corner, has barycentric coordinates above `margin`.
[[nodiscard]] bool is_within(const std::array<Vec3, 4>& corners, const Vec3& from_first, double margin);

// The point, relative to the first corner, whose barycentric coordinates are those of `from_first`, none below
// `margin`.
[[nodiscard]] Vec3 moved_within(const std::array<Vec3, 4>& corners, const Vec3& from_first, double margin);

}  // namespace raycone
