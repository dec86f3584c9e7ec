// Where a segment meets triangles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/data/box.h"
#include "core/data/triangle_mesh.h"
#include "core/exact/long_vec3.h"

namespace raycone {

// A point of a segment from p to q on a triangle.
struct SegmentHit {
  double at = 0.0;  // p + at (q - p); within 1e-15 of the exact number, unless the triangle is a needle
  std::uint32_t triangle = 0;
  std::int8_t jump = 0;  // by how much w changes there on the way from p to q; 0: not known
};

// The point that the closed segment and the closed triangle have in common, where there is just one: nothing where the
// triangle is parallel to the segment, or has no area. Whether there is one is exact, for all finite doubles. Needs
// DefaultFloatingPoint. Thread-safe.
[[nodiscard]] std::optional<double> segment_hit(const Vec3& p, const Vec3& q, const Corners3& triangle);

// segment_hit() of segments that have an end in common, with the same triangles. What they have in common is found
// once.
class HitFinder {
 public:
  // The mesh must stay as it is.
  explicit HitFinder(const TriangleMesh& mesh) : mesh_(mesh) {}

  // From now on find() is about segments from this end, and about these triangles of the mesh.
  void enter(const Vec3& end, std::span<const std::uint32_t> triangles);

  enum class Way : std::uint8_t { kFromEnd, kToEnd };
  // Sets `hits` to the hits on the way from the end to `other`, or back, in order; of equal ones the lowest triangle
  // first. Jumps are known where the segment passes through the inside of the triangle, from one side to the other.
  void find(const Vec3& other, Way way, std::vector<SegmentHit>& hits);

 private:
  // The cross product of two differences of points.
  struct Turn {
    Vec3 value, terms;  // terms: the magnitudes of its products, added
  };
  // What is not known yet is found when a segment's box meets that of the triangle. What is of the plane alone stays
  // for the next end, which mostly has the same triangles.
  struct Known {
    Corners3 corners;
    Box box;
    std::uint32_t triangle = 0xFFFFFFFF;
    bool has_plane = false, has_sides = false, has_distance = false;
    Turn normal;  // of its plane
    LongVec3 long_normal;
    int side = 0;               // of its plane, on which the end is
    std::array<Turn, 3> sides;  // of the planes through the end and a side
    long double of_end = 0;     // how far the end is from its plane, times the normal's length
  };

  static void find_plane(Known& t);
  void find_sides(Known& t) const;
  [[nodiscard]] static Turn turn_of(const Vec3& u, const Vec3& v);
  [[nodiscard]] static int plane_side_of(const Known& t, const Vec3& p);
  enum class Passage : std::uint8_t { kBeside, kAtSide, kInside };
  [[nodiscard]] Passage passage(const Known& t, const Vec3& other) const;
  [[nodiscard]] std::optional<SegmentHit> hit(Known& t, const Vec3& other, Way way) const;

  Vec3 end_;
  const TriangleMesh& mesh_;
  std::vector<Known> triangles_;  // the first `count_` of them: others are old
  std::size_t count_ = 0;
};

}  // namespace raycone
