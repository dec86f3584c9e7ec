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

using TrianglesAround = std::array<std::array<ExactPoints::Number, 3>, 3>;  // by axis: x, y, z

struct PlaneGroup {
  struct Face {
    std::uint32_t number;  // of the caller's, returned as PlanePiece::face
    std::array<ExactPoints::Number, 3> corners;
  };
  std::vector<Face> faces;                                                    // at least one; none of zero area
  std::vector<std::pair<ExactPoints::Number, ExactPoints::Number>> segments;  // their ends
  std::vector<ExactPoints::Number> points;                                    // others that must become corners
};

// A triangle of the plane, all of whose points are in the same faces.
struct PlanePiece {
  std::array<ExactPoints::Number, 3> corners;  // as most of its faces run around
  std::uint32_t face;                          // PlaneGroup::Face::number of one that it is part of
  std::int32_t multiplicity;                   // positive: how many more of its faces run this way than the other
};

// Where segments of the group and edges of its faces cross each other. An end of one on another is no crossing: it is a
// point already. None if that takes too long. Thread-safe.
[[nodiscard]] std::optional<std::vector<ExactPoints::Crossing>> crossings_of(const PlaneGroup& group,
                                                                             const ExactPoints& points, Effort& effort);

// Cuts the faces along the edges of all faces and along all segments. Every point of the group becomes a corner. Pieces
// that as many faces cover in either direction are left out. None if that takes too long. Precondition: the group has
// its crossings_of() among its points. `around`: ExactPoints::add_triangle_around() along each axis. Thread-safe.
[[nodiscard]] std::optional<std::vector<PlanePiece>> cut(const PlaneGroup& group, const ExactPoints& points,
                                                         const TrianglesAround& around, Effort& effort);

}  // namespace raycone
