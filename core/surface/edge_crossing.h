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

// segment_hit() of segments that have an end in common, with the same triangles. What they have in common is found
// once.
class HitFinder {
 public:
  // The mesh must stay where it is until all segments of this end have been asked about.
  void enter(const Vec3& end, const TriangleMesh& mesh, std::span<const std::uint32_t> triangles);

  // Sets `hits` to those from the end to `other`, or back; of equal ones the lowest triangle first.
  void find(const Vec3& other, bool from_end, std::vector<SegmentHit>& hits);

 private:
  struct Known {
    const Vec3 *a, *b, *c;
    Box box;
    std::uint32_t triangle;
    std::optional<int> side;  // of its plane, on which the end is
  };

  Vec3 end_;
  std::vector<Known> triangles_;
};

// The unit normal of a triangle that has an area; within 1e-15 unless it is a needle.
[[nodiscard]] Vec3 unit_normal(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace raycone
