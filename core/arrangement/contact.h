// Where two faces of a mesh meet.
#pragma once

#include <vector>

#include "core/exact/exact_points.h"
#include "core/intersections/triangle_pair.h"

namespace raycone {

// What two triangles have in common: nothing, a point, or a segment, given by its ends. Each end is a corner of a
// triangle, or a point where an edge passes through the other triangle; one may be named several times.
struct Contact {
  bool is_of_one_plane = false;  // the triangles are of one plane; then no ends are given
  std::vector<Vec3> corners;
  std::vector<ExactPoints::OnPlane> passes;
};

// Precondition: neither triangle has zero area. Thread-safe.
[[nodiscard]] Contact contact_of(const Corners3& s, const Corners3& t);

}  // namespace raycone
