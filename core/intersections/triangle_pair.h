// Whether two triangles of a mesh meet where they should not.
#pragma once

#include "core/data/triangle_mesh.h"

namespace raycone {

// Whether the closed triangles have a point in common that lies on no vertex and on no edge of both. A vertex is of
// both where its position is, an edge where both its ends are. So neighbours may touch in what they share; two
// triangles of the same three corners overlap. A triangle of zero area is the segment or the point that its corners
// span. Symmetric, and the same for any order of corners. Exact for all finite doubles. Thread-safe; needs
// DefaultFloatingPoint.
[[nodiscard]] bool meet_beyond_shared(const Corners3& s, const Corners3& t);

// The same, of one triangle and many others. Sooner where floating point is sure that the other one is beside it, as it
// is of most neighbours.
class MeetsBeyondShared {
 public:
  explicit MeetsBeyondShared(const Corners3& triangle);

  [[nodiscard]] bool operator()(const Corners3& other) const {
    return !is_surely_beside(other) && meet_beyond_shared(triangle_, other);
  }

 private:
  // Of two edges: compilers do not make vectors of these loops by themselves.
  using Two = double __attribute__((vector_size(16)));
  struct Edges {
    Two from_first, from_second;  // where they start, by the two coordinates that are looked at,
    Two step_first, step_second;  // and their ways: turns to the outer side are negative
    Two start_x, start_y, start_z, end_x, end_y, end_z;
  };

  [[nodiscard]] bool is_surely_beside(const Corners3& other) const;

  Corners3 triangle_;
  // It is seen along an axis; the next two, cyclically, remain. A line along an edge has all of it on its inner side.
  int first_axis_, second_axis_;
  Edges edges_[2];  // the first edge comes twice
  bool has_sides_;  // else the turns of the triangle itself are not sure
};

}  // namespace raycone
