// Signed crossings of the rays of a row with triangles.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/crossings/row.h"
#include "core/data/vec3.h"

namespace raycone {

// Where a triangle's plane meets lines along x, in floating point.
struct TrianglePlane {
  Vec3 normal;  // (b - a) x (c - a), rounded
  // Bound of |x^ - x| where a line through the triangle's box meets the plane; infinite where none is known.
  double error = 0;

  TrianglePlane(const Vec3& a, const Vec3& b, const Vec3& c);
};

// What one triangle says about the samples of a row. Each statement holds for a range of them.
struct TriangleCrossing {
  int sigma = 0;  // +-1: crossed by the rays of the samples [0, crossed), sign of the normal's x
  std::size_t crossed = 0;
  int ties = 0;  // edges with D = 0, of a triangle whose closed box meets the rays of the samples [0, met)
  std::size_t met = 0;
  std::size_t on_begin = 0;  // the samples [on_begin, on_end) lie on the closed triangle
  std::size_t on_end = 0;
};

// What one triangle says about one query.
struct QueryCrossing {
  int sigma = 0;            // +-1: its ray crosses the triangle, sign of the normal's x; else 0
  int ties = 0;             // edges with D = 0, of a triangle whose closed box its ray meets
  bool on_surface = false;  // it lies on the closed triangle
};

// A ray, by its number among others, and a triangle that it may cross or tie with.
struct RayCandidate {
  std::uint32_t query;
  std::uint32_t triangle;
};

// Exact. `plane` is that of the triangle; nullptr: predicates alone decide, which is cheaper for few samples. Needs
// DefaultFloatingPoint.
[[nodiscard]] TriangleCrossing triangle_crossing(const Vec3& a, const Vec3& b, const Vec3& c, const Row& row,
                                                 const TrianglePlane* plane = nullptr);
[[nodiscard]] inline QueryCrossing triangle_crossing(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& q) {
  const TriangleCrossing row = triangle_crossing(a, b, c, Row{q.y, q.z, {&q.x, 1}});
  return {row.crossed > 0 ? row.sigma : 0, row.met > 0 ? row.ties : 0, row.on_begin < row.on_end};
}

}  // namespace raycone
