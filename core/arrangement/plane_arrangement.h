// Faces of one plane, cut along each other and along segments in that plane.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/arrangement/effort.h"
#include "core/exact/exact_points.h"

namespace raycone {

using TrianglesAround = std::array<std::array<ExactPoints::Number, 3>, 3>;  // along each axis

struct PlaneGroup {
  struct Face {
    std::uint32_t number;  // what it is called
    std::array<ExactPoints::Number, 3> corners;
  };
  std::vector<Face> faces;  // at least one; none of zero area
  std::vector<std::pair<ExactPoints::Number, ExactPoints::Number>> segments;
  std::vector<ExactPoints::Number> points;
};

// A triangle of the plane, all of whose points are in the same faces.
struct PlanePiece {
  std::array<ExactPoints::Number, 3> corners;  // in the direction of most of its faces
  std::uint32_t face;                          // the number of one that it is part of
  std::int32_t multiplicity;                   // positive: how many faces of this direction more than of the other
};

// Where segments of a group cross each other or edges of faces: not where one ends on the other, which is a point
// already. None if that takes too long.
[[nodiscard]] std::optional<std::vector<ExactPoints::Crossing>> crossings_of(const PlaneGroup& group,
                                                                             const ExactPoints& points, Effort& effort);

// The pieces that the faces have between the edges of all faces and all segments; pieces of which as many faces go
// either way are left out. Every point of the group is a corner. None if that takes too long. Precondition: the group
// has its crossings among its points. `around`: ExactPoints::add_triangle_around() along each axis. Thread-safe.
[[nodiscard]] std::optional<std::vector<PlanePiece>> cut(const PlaneGroup& group, const ExactPoints& points,
                                                         const TrianglesAround& around, Effort& effort);

}  // namespace raycone
