// Where two faces of a mesh meet.
#pragma once

#include <vector>

#include "core/exact/exact_points.h"
#include "core/intersections/triangle_pair.h"

namespace raycone {

// The common points of two triangles that are not of one plane are one, or a segment between two.
struct Contact {
  bool is_of_one_plane = false;
  std::vector<ExactPoints::Number> ends;  // none where they are of one plane
};

// Precondition: neither triangle has zero area.
[[nodiscard]] Contact contact_of(const Corners3& s, const Corners3& t, ExactPoints& points);

}  // namespace raycone
