// Planes of triangles, and where they meet.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/data/triangle_mesh.h"

namespace raycone {

struct SourcePlane {
  Vec3 point, normal;  // of length 1; zero where the triangle has no area
  std::int32_t source;

  [[nodiscard]] double height(const Vec3& p) const { return dot(normal, p - point); }
};

// Precondition: `source` is a triangle of `input`.
[[nodiscard]] SourcePlane source_plane(const TriangleMesh& input, std::int32_t source);

// Whether two planes are one within `off`, near the point `near`; whichever way they look.
[[nodiscard]] bool is_same_plane(const SourcePlane& a, const SourcePlane& b, const Vec3& near, double off);

// The point of two or three planes that is nearest to `near`. Nothing for fewer or more planes, or where three hardly
// have a point in common. Precondition: two planes are at an angle that is not too small.
[[nodiscard]] std::optional<Vec3> meeting_point(std::span<const SourcePlane> planes, const Vec3& near);

}  // namespace raycone
