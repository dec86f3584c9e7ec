// Where two faces of a mesh meet.
#pragma once

#include <vector>

#include "core/exact/exact_points.h"
#include "core/intersections/triangle_pair.h"

namespace raycone {

// The common points of two triangles that are not of one plane are one, or a segment between two. These are corners of
// the triangles, or where edges pass through them; one may be named several times.
struct Contact {
  bool is_of_one_plane = false;  // then nothing is named
  std::vector<Vec3> corners;
  std::vector<ExactPoints::OnPlane> passes;
};

// Precondition: neither triangle has zero area. Thread-safe.
[[nodiscard]] Contact contact_of(const Corners3& s, const Corners3& t);

}  // namespace raycone
