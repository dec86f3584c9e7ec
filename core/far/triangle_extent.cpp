#include "core/far/triangle_extent.h"

#include <algorithm>
#include <cmath>

#include "core/data/triangle_mesh.h"

namespace raycone {
namespace {

constexpr double kRoundsDown = 1 - 0x1p-40, kRoundsUp = 1 + 0x1p-40;

// How far the box is, at least, from all of the corners' triangle in a direction; 0 where it is not known to be in
// front of it. What differences, products and sums round is below the share that is taken off (docs/method.md, "Rules
// on lattices"), whatever the direction.
double gap_along(const Vec3& direction, const Corners3& corners, const Box& box) {
  constexpr double kLeast = 0x1p-400;  // squares of less lose bits
  constexpr double kGapRounds = 0x1p-45;
  const double length = norm(direction);
  if (!(length >= kLeast)) return 0.0;
  const Vec3 half = 0.5 * (box.upper - box.lower), centre = middle(box);
  const double reach = std::abs(direction.x) * half.x + std::abs(direction.y) * half.y + std::abs(direction.z) * half.z;
  double least = dot(direction, centre - corners[0]), farthest = largest_coordinate(box);
  for (const Vec3& corner : corners) {
    least = std::min(least, dot(direction, centre - corner));
    farthest = std::max(farthest, largest_coordinate(corner));
  }
  const double gap = (least - reach) / length - kGapRounds * farthest;
  return gap > 0.0 ? gap * kRoundsDown : 0.0;
}

}  // namespace

TriangleExtent extent_of(const SolidTriangle& t) {
  const double area = safe_norm(t.normal) / 2 * kRoundsUp;
  const double longest = std::max({safe_norm(t.b - t.a), safe_norm(t.c - t.b), safe_norm(t.a - t.c)});
  return {box_of(t.a, t.b, t.c), area, 2 * area / longest * kRoundsUp};
}

// The plane's normal and those of its lines are at right angles but for rounding.
double square_of_gap(const SolidTriangle& t, const TriangleExtent& extent, const Box& box) {
  const Corners3 corners{t.a, t.b, t.c};
  const Vec3 back{-t.normal.x, -t.normal.y, -t.normal.z};
  const double from_plane = std::max(gap_along(t.normal, corners, box), gap_along(back, corners, box));
  double within = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 outward = cross(corners[(i + 1) % 3] - corners[i], t.normal);
    within = std::max(within, gap_along(outward, corners, box));
  }
  const double from_box = square_of_gap(extent.box, box);
  return std::max(from_box, from_plane * from_plane + within * within) * kRoundsDown;
}

}  // namespace raycone
