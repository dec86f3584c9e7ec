// Where a segment meets triangles.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// A point of a segment from p to q on a triangle.
struct SegmentHit {
  double at = 0.0;  // p + at (q - p); within 1e-15 of the exact number, unless the triangle is a needle
  std::uint32_t triangle = 0;
};

// The point that the closed segment and the closed triangle have in common, where there is just one: nothing where the
// triangle is parallel to the segment, or has no area. Whether there is one is exact, for all finite doubles. Needs
// DefaultFloatingPoint. Thread-safe.
[[nodiscard]] std::optional<double> segment_hit(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b,
                                                const Vec3& c);

// Sets `hits` to those of some triangles of a mesh, from p to q; of equal ones the lowest triangle first.
void find_segment_hits(const Vec3& p, const Vec3& q, const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
                       std::vector<SegmentHit>& hits);

// The unit normal of a triangle that has an area; within 1e-15 unless it is a needle.
[[nodiscard]] Vec3 unit_normal(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace raycone
