#include "core/intersections/triangle_pair.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "core/data/box.h"
#include "core/exact/predicates.h"

namespace raycone {
namespace {

struct Segment3 {
  Vec3 from, to;
};

bool is_flat(const Corners3& t) { return collinear(t[0], t[1], t[2]); }

// Coordinates `axis` and `axis + 1`, cyclically, as the two that signs of edges look at.
Vec3 in_plane(int axis, const Vec3& p) { return {0.0, p[axis], p[(axis + 1) % 3]}; }

int orientation_in_plane(int axis, const Vec3& a, const Vec3& b, const Vec3& c) {
  return exact_edge_orientation(in_plane(axis, a), in_plane(axis, b), in_plane(axis, c));
}

// An axis along which the triangle, which has an area, does not become a segment.
int axis_of(const Corners3& t) {
  int axis = 0;
  while (axis < 2 && orientation_in_plane(axis, t[0], t[1], t[2]) == 0) ++axis;
  return axis;
}

// Whether two closed segments meet, which may be points.
bool segments_meet(const Segment3& s, const Segment3& t) {
  if (!overlap(box_of(s.from, s.to), box_of(t.from, t.to))) return false;
  if (plane_side(s.from, s.to, t.from, t.to) != 0) return false;
  // In one plane they meet where no axis shows the ends of one on one side of the other. On a line, boxes tell.
  for (int axis = 0; axis < 3; ++axis) {
    const auto apart = [axis](const Segment3& line, const Segment3& other) {
      return orientation_in_plane(axis, line.from, line.to, other.from) *
                 orientation_in_plane(axis, line.from, line.to, other.to) >
             0;
    };
    if (apart(s, t) || apart(t, s)) return false;
  }
  return true;
}

std::array<Segment3, 3> edges_of(const Corners3& t) { return {{{t[0], t[1]}, {t[1], t[2]}, {t[2], t[0]}}}; }

bool meets_an_edge(const Segment3& s, const Corners3& t) {
  return std::ranges::any_of(edges_of(t), [&s](const Segment3& edge) { return segments_meet(s, edge); });
}

// Whether a closed segment meets the closed triangle; either may be of lower dimension: a triangle without area has all
// points in its plane.
bool meets(const Segment3& s, const Corners3& t) {
  const int from = plane_side(t[0], t[1], t[2], s.from), to = plane_side(t[0], t[1], t[2], s.to);
  if (from * to > 0) return false;
  if (from == 0 && to == 0) return on_triangle(t[0], t[1], t[2], s.from) || meets_an_edge(s, t);
  // The segment's line crosses the plane once, and the triangle where it passes no edge on the outer side.
  int least = 1, most = -1;
  for (const Segment3& edge : edges_of(t)) {
    const int side = plane_side(s.from, s.to, edge.from, edge.to);
    least = std::min(least, side);
    most = std::max(most, side);
  }
  return least >= 0 || most <= 0;
}

// On which sides of the plane of `t` the corners of `s` lie.
struct Sides {
  int least, most;
  [[nodiscard]] bool is_one() const { return least == most && least != 0; }
  [[nodiscard]] bool is_none() const { return least == 0 && most == 0; }
};

Sides sides_of(const Corners3& s, const Corners3& t) {
  const auto [least, most] = std::minmax(
      {plane_side(t[0], t[1], t[2], s[0]), plane_side(t[0], t[1], t[2], s[1]), plane_side(t[0], t[1], t[2], s[2])});
  return {least, most};
}

// Whether the line of an edge of `s` has all of `t` strictly on its outer side, seen along an axis.
bool edge_separates(int axis, const Corners3& s, const Corners3& t) {
  const int whole = orientation_in_plane(axis, s[0], s[1], s[2]);
  return std::ranges::any_of(edges_of(s), [&](const Segment3& edge) {
    return std::ranges::all_of(
        t, [&](const Vec3& p) { return orientation_in_plane(axis, edge.from, edge.to, p) * whole < 0; });
  });
}

bool any_edge_meets(const Corners3& s, const Corners3& t) {
  return std::ranges::any_of(edges_of(s), [&t](const Segment3& edge) { return meets(edge, t); });
}

bool triangles_meet(const Corners3& s, const Corners3& t) {
  const Sides sides = sides_of(s, t);
  if (sides.is_one() || sides_of(t, s).is_one()) return false;
  if (sides.is_none() && !is_flat(s) && !is_flat(t)) {
    // Convex polygons are apart where an edge's line tells them apart. Flat parts of a mesh have many such pairs.
    const int axis = axis_of(t);
    return !edge_separates(axis, s, t) && !edge_separates(axis, t, s);
  }
  return any_edge_meets(s, t) || any_edge_meets(t, s);
}

// Whether b lies beyond or on the way from `apex` to a, on one line with them. Neither is the apex.
bool is_same_way(const Vec3& apex, const Vec3& a, const Vec3& b) {
  if (!collinear(apex, a, b)) return false;
  for (int axis = 0; axis < 3; ++axis) {
    if (a[axis] != apex[axis]) return (a[axis] > apex[axis]) == (b[axis] > apex[axis]);
  }
  return false;
}

// Whether the way from the corner t[0] to `end` starts within the triangle, at its edges included. Corners of `t` may
// be on one line.
bool starts_within(const Vec3& end, const Corners3& t) {
  const Vec3& apex = t[0];
  if (end == apex) return false;
  if (is_flat(t)) {
    return (t[1] != apex && is_same_way(apex, t[1], end)) || (t[2] != apex && is_same_way(apex, t[2], end));
  }
  if (plane_side(t[0], t[1], t[2], end) != 0) return false;
  const int axis = axis_of(t);
  const int whole = orientation_in_plane(axis, t[0], t[1], t[2]);
  return orientation_in_plane(axis, apex, t[1], end) * whole >= 0 &&
         orientation_in_plane(axis, apex, end, t[2]) * whole >= 0;
}

// Of triangles whose first corner is at one position, and no other.
bool meet_beyond_corner(const Corners3& s, const Corners3& t) {
  const auto far_edge_beside = [](const Corners3& a, const Corners3& b) {
    return plane_side(b[0], b[1], b[2], a[1]) * plane_side(b[0], b[1], b[2], a[2]) > 0;
  };
  if (far_edge_beside(s, t) || far_edge_beside(t, s)) return false;
  if (is_flat(s)) return starts_within(s[1], t) || starts_within(s[2], t);
  if (is_flat(t)) return starts_within(t[1], s) || starts_within(t[2], s);
  // Where they have more in common they have a way from the corner, and it leaves one of them through the edge
  // opposite.
  return meets({s[1], s[2]}, t) || meets({t[1], t[2]}, s);
}

// Of triangles whose first two corners are at the same two positions; the third are at different ones.
bool meet_beyond_edge(const Corners3& s, const Corners3& t) {
  const Vec3 &from = s[0], &to = s[1];
  if (plane_side(from, to, s[2], t[2]) != 0) return false;
  const bool s_is_flat = is_flat(s), t_is_flat = is_flat(t);
  if (s_is_flat != t_is_flat) return false;  // a segment on the line of the edge meets the other in no more
  if (s_is_flat) {
    // Both pass the same end of the edge. A corner that repeats an end passes none.
    const auto both_pass = [&](const Vec3& end, const Vec3& other) {
      const auto passes = [&](const Vec3& p) { return p != end && p != other && !is_same_way(end, other, p); };
      return passes(s[2]) && passes(t[2]);
    };
    return both_pass(from, to) || both_pass(to, from);
  }
  const int axis = axis_of(s);
  return orientation_in_plane(axis, from, to, s[2]) == orientation_in_plane(axis, from, to, t[2]);
}

// orientation_in_plane() where floating point is sure of it, else 0.
int sure_turn(int axis, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 origin = in_plane(axis, a);
  return sure_sign(determinant_from(origin, origin, in_plane(axis, b), in_plane(axis, c)));
}

// Of the three planes of orientation_in_plane(), the one in which the triangle looks largest, up to rounding.
int widest_plane(const Corners3& t) {
  const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
  const Vec3 size{std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
  return size.x >= size.y && size.x >= size.z ? 1 : size.y >= size.z ? 2 : 0;
}

// Whether, seen along one axis, a line through all positions that both have, along an edge of `s`, has the rest of `t`
// on the outer side for sure: most pairs of neighbours in one plane, where exact signs of volumes cost most. Of
// triangles whose first `shared` corners are at the same positions.
bool is_surely_beside(const Corners3& s, const Corners3& t, std::size_t shared) {
  const int axis = widest_plane(s), whole = sure_turn(axis, s[0], s[1], s[2]);
  if (whole == 0) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t next = (i + 1) % 3, opposite = (i + 2) % 3;
    if (opposite < shared) continue;  // its edge does not pass all of them
    const auto is_outside = [&](const Vec3& p) { return sure_turn(axis, s[i], s[next], p) == -whole; };
    if (std::all_of(t.begin() + static_cast<std::ptrdiff_t>(shared), t.end(), is_outside)) return true;
  }
  return false;
}

// Brings the corners at positions of both to the front, in the same order. Returns their number. What repeats a corner
// of its own triangle stays behind.
std::size_t shared_first(Corners3& s, Corners3& t) {
  std::size_t shared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto known = std::span(s).first(shared);
    if (std::ranges::find(known, s[i]) != known.end()) continue;
    const auto same = std::find(t.begin() + static_cast<std::ptrdiff_t>(shared), t.end(), s[i]);
    if (same == t.end()) continue;
    std::swap(*same, t[shared]);
    std::swap(s[i], s[shared]);
    ++shared;
  }
  return shared;
}

}  // namespace

bool meet_beyond_shared(const Corners3& s, const Corners3& t) {
  Corners3 a = s, b = t;
  const std::size_t shared = shared_first(a, b);
  if (shared < 3 && (is_surely_beside(a, b, shared) || is_surely_beside(b, a, shared))) return false;
  switch (shared) {
    case 0:
      return triangles_meet(a, b);
    case 1:
      return meet_beyond_corner(a, b);
    case 2:
      return meet_beyond_edge(a, b);
    default:
      return !is_flat(a);  // of one without an area, the edges are all that there is
  }
}

MeetsBeyondShared::MeetsBeyondShared(const Corners3& triangle) : triangle_(triangle) {
  const int axis = widest_plane(triangle), whole = sure_turn(axis, triangle[0], triangle[1], triangle[2]);
  first_axis_ = axis;
  second_axis_ = (axis + 1) % 3;
  has_sides_ = whole != 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 &start = triangle[i % 3], &end = triangle[(i + 1) % 3];
    Edges& edges = edges_[i / 2];
    edges.from_first[i % 2] = start[first_axis_];
    edges.from_second[i % 2] = start[second_axis_];
    edges.step_first[i % 2] = whole * (end[first_axis_] - start[first_axis_]);
    edges.step_second[i % 2] = whole * (end[second_axis_] - start[second_axis_]);
    edges.start_x[i % 2] = start.x;
    edges.start_y[i % 2] = start.y;
    edges.start_z[i % 2] = start.z;
    edges.end_x[i % 2] = end.x;
    edges.end_y[i % 2] = end.y;
    edges.end_z[i % 2] = end.z;
  }
}

// As is_surely_beside() has it for either of two triangles: the line of one edge has all corners of the other on its
// outer side, but for those that are ends of the edge. So they have nothing in common but these, or that edge.
bool MeetsBeyondShared::is_surely_beside(const Corners3& other) const {
  if (!has_sides_) return false;
  constexpr Two kZero{0.0, 0.0};
  const auto size = [&](Two x) { return x < kZero ? -x : x; };
  for (const Edges& edges : edges_) {
    auto beside = ~decltype(Two{} < kZero){};
    for (const Vec3& p : other) {
      // As in determinant_from() and sure_sign().
      const Two left = (edges.from_first - p[first_axis_]) * edges.step_second;
      const Two right = (edges.from_second - p[second_axis_]) * edges.step_first;
      const Two trust = kSideFilter * (size(left) + size(right)) + kSideUnderflow;
      const auto is_start = (edges.start_x == p.x) & (edges.start_y == p.y) & (edges.start_z == p.z);
      const auto is_end = (edges.end_x == p.x) & (edges.end_y == p.y) & (edges.end_z == p.z);
      beside &= (left - right < -trust) | is_start | is_end;
    }
    if ((beside[0] | beside[1]) != 0) return true;
  }
  return false;
}

}  // namespace raycone
